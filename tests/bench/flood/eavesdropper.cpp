// SPDX-License-Identifier: MIT
#include "tests/bench/flood/eavesdropper.hpp"

#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>
#include <stdexcept>

namespace hapticast::testing {

namespace {

constexpr std::size_t kForgedBytes = 600;   // a usual one
constexpr std::uint64_t kMostAtOnce = 512;  // of a late turn
const auto kHere = asio::ip::address_v4::loopback();

sockaddr_in here(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

}  // namespace

Eavesdropper::Eavesdropper(std::uint16_t server_port)
    : server_port_(server_port), raw_(::socket(AF_INET, SOCK_RAW | SOCK_NONBLOCK, IPPROTO_UDP)) {
  if (raw_ < 0)
    throw std::runtime_error(std::string("raw sockets are not allowed here: ") +
                             std::strerror(errno));
  own_.open(asio::ip::udp::v4());
  closed_.open(asio::ip::udp::v4());
  closed_.bind({kHere, 0});
  closed_port_ = closed_.local_endpoint().port();
  closed_.close();
}

Eavesdropper::~Eavesdropper() { ::close(raw_); }

bool Eavesdropper::listen() {
  std::array<std::uint8_t, 2048> packet{};
  while (viewer_port_ == 0) {
    const ssize_t size = ::recv(raw_, packet.data(), packet.size(), 0);
    if (size < 0) break;
    const auto* const ip = reinterpret_cast<const iphdr*>(packet.data());
    const std::size_t before = std::size_t{4} * ip->ihl + sizeof(udphdr);
    if (static_cast<std::size_t>(size) < before) continue;
    udphdr udp{};
    std::memcpy(&udp, packet.data() + before - sizeof udp, sizeof udp);
    if (ntohs(udp.source) != server_port_) continue;
    const auto seen =
        readDatagram(std::span(packet).first(static_cast<std::size_t>(size)).subspan(before));
    if (!seen || seen->header.probe()) continue;
    viewer_port_ = ntohs(udp.dest);
    token_ = seen->token;
    newest_ = seen->header;
  }
  return viewer_port_ != 0;
}

std::vector<std::uint8_t> Eavesdropper::forged(Knows knows) {
  std::vector<std::uint8_t> bytes(kForgedBytes);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_());
  if (knows != Knows::kToken) return bytes;
  DatagramHeader header = newest_;
  header.frame += random_() % 2000;  // as far ahead as a client may look for them
  header.parts = 20;
  header.part = static_cast<std::uint16_t>(random_() % header.parts);
  // Signed with another key: a signature that is no number is seen to be none at a glance.
  bytes.resize(kForgedBytes - kDatagramHeaderBytes - kSignatureBytes);
  bytes = signedBody(header, bytes, another_key_);
  const TokenBytes front = tokenBytes(token_);
  bytes.insert(bytes.begin(), front.begin(), front.end());
  return bytes;
}

void Eavesdropper::flood(Knows knows, bool at_closed_port, double rate_Hz, LocalTime now) {
  if (!begun_at_) begun_at_ = now;
  const auto due = static_cast<std::uint64_t>(toSeconds(now - *begun_at_) * rate_Hz);
  const std::uint64_t count = std::min(due - tried_, kMostAtOnce);
  tried_ = due;
  if (count == 0) return;
  // What is forged is made once a turn: making it costs more than sending it.
  const std::vector<std::uint8_t> body = forged(knows);
  std::vector<std::uint8_t> packet(sizeof(udphdr) + body.size());
  const sockaddr_in to = here(at_closed_port ? closed_port_ : viewer_port_);
  udphdr udp{};
  udp.source = htons(server_port_);
  udp.dest = to.sin_port;
  udp.len = htons(static_cast<std::uint16_t>(packet.size()));
  std::memcpy(packet.data(), &udp, sizeof udp);
  std::copy(body.begin(), body.end(), packet.begin() + sizeof udp);
  for (std::uint64_t i = 0; i < count; ++i) {
    // Another part and another frame each time; signatures are wrong all the same.
    packet[sizeof udp + 32] = static_cast<std::uint8_t>(i % 20);
    const bool raw = knows != Knows::kNothing;
    const auto& bytes = raw ? packet : body;
    const ssize_t gone = ::sendto(raw ? raw_ : own_.native_handle(), bytes.data(), bytes.size(),
                                  MSG_DONTWAIT, reinterpret_cast<const sockaddr*>(&to), sizeof to);
    sent_ += gone > 0 ? 1 : 0;
  }
}

}  // namespace hapticast::testing
