// SPDX-License-Identifier: MIT
#include "client/net/udp/udp_socket.hpp"

#include <netinet/in.h>
#include <algorithm>
#include <cstring>
#include <utility>

#include "common/transport/network_interfaces.hpp"

namespace hapticast::client {

DatagramCounts DatagramCounts::operator+(const DatagramCounts& other) const {
  return {received + other.received,    repeated + other.repeated, foreign + other.foreign,
          astray + other.astray,        forged + other.forged,     over_budget + other.over_budget,
          not_opened + other.not_opened};
}

DatagramVerifier::DatagramVerifier(std::uint64_t token, std::uint32_t stream, VerifyingKey key,
                                   DatagramKeyRing& keys)
    : token_(token), stream_(stream), key_(std::move(key)), keys_(&keys) {}

std::optional<Datagram> DatagramVerifier::verify(std::span<const std::uint8_t> bytes, LocalTime now,
                                                 const IsWanted& want) {
  auto datagram = readDatagram(bytes);
  if (!datagram || datagram->token != token_ || datagram->header.stream != stream_) {
    ++counts_.foreign;
    return std::nullopt;
  }
  using Want = FrameAssembler::Want;
  const Want wanted = datagram->header.probe() ? Want::kNew : want(datagram->header);
  if (wanted != Want::kNew) {
    ++(wanted == Want::kHad ? counts_.repeated : counts_.astray);
    return std::nullopt;
  }
  using Check = DatagramKeyRing::Check;
  const Check check = keys_->check(*datagram, now);
  if (check != Check::kOpenable) {
    ++(check == Check::kRepeated ? counts_.repeated : counts_.not_opened);
    return std::nullopt;
  }
  if (!mayVerify(now)) {
    ++counts_.over_budget;
    return std::nullopt;
  }
  if (!key_.verify(datagram->signed_bytes, datagram->signature)) {
    ++counts_.forged;
    return std::nullopt;
  }
  if (!keys_->open(*datagram)) {
    ++counts_.not_opened;
    return std::nullopt;
  }
  ++counts_.received;
  return datagram;
}

bool DatagramVerifier::mayVerify(LocalTime now) {
  const LocalTime latest = std::max(budget_at_.value_or(now), now);
  const double since_s = toSeconds(latest - budget_at_.value_or(latest));
  budget_at_ = latest;
  budget_ = std::min(kBurst, budget_ + kVerifications_Hz * since_s);
  if (budget_ < 1.0) return false;
  budget_ -= 1.0;
  return true;
}

namespace {

using asio::ip::udp;

// Chosen: half a second of a large frame at 60 frames/s, so that a late thread loses nothing.
constexpr int kReceiveBufferBytes = 2 << 20;
// Chosen: then other tasks of this thread run.
constexpr int kMostAtOnce = 64;

Result<udp::endpoint> resolveEndpoint(const Endpoint& endpoint) {
  boost::system::error_code ec;
  const auto address = asio::ip::make_address(endpoint.host, ec);
  if (ec) return Error{"'" + endpoint.host + "' is not an IP address"};
  return udp::endpoint(address, endpoint.port);
}

void enlargeBuffer(udp::socket& socket) {
  boost::system::error_code ignored;  // a smaller buffer only loses more in a burst
  socket.set_option(asio::socket_base::receive_buffer_size(kReceiveBufferBytes), ignored);
}

/// Converts the system's error to a text for the user.
Error makeError(const boost::system::error_code& ec) { return Error{ec.message()}; }

/// Returns the index of the interface `called`; with an empty name that of the route to the server.
Result<unsigned> findInterface(asio::io_context& io, const std::string& called,
                               const Endpoint& server) {
  std::string name = called;
  if (name.empty()) {
    const auto to = resolveEndpoint(server);
    if (!to.ok()) return to.error();
    udp::socket probe(io, to.value().protocol());
    boost::system::error_code ec;
    probe.connect(to.value(), ec);  // asks the system for its route and sends nothing
    if (!ec) name = probe.local_endpoint(ec).address().to_string();
    if (ec) return makeError(ec);
  }
  const auto all = networkInterfaces();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.hasName(name); });
  if (found == all.end()) return Error{"this machine has no network '" + name + "'"};
  return found->index;
}

}  // namespace

UdpSocket::UdpSocket(udp::socket socket, const Clock& clock, DatagramVerifier verifier)
    : socket_(std::move(socket)), clock_(clock), verifier_(std::move(verifier)) {}

Result<std::shared_ptr<UdpSocket>> UdpSocket::toServer(asio::io_context& io, const Clock& clock,
                                                       const Endpoint& server,
                                                       DatagramVerifier verifier) {
  const auto to = resolveEndpoint(server);
  if (!to.ok()) return to.error();
  udp::socket socket(io);
  boost::system::error_code ec;
  socket.open(to.value().protocol(), ec);
  if (!ec) socket.connect(to.value(), ec);
  if (!ec) socket.non_blocking(true, ec);
  if (ec) return makeError(ec);
  enlargeBuffer(socket);
  return std::shared_ptr<UdpSocket>(new UdpSocket(std::move(socket), clock, std::move(verifier)));
}

Result<std::shared_ptr<UdpSocket>> UdpSocket::ofGroup(asio::io_context& io, const Clock& clock,
                                                      const Endpoint& group,
                                                      const std::string& interface,
                                                      const Endpoint& server,
                                                      DatagramVerifier verifier) {
  auto at = resolveEndpoint(group);
  if (!at.ok()) return at.error();
  const auto index = findInterface(io, interface, server);
  if (!index.ok()) return index.error();
  if (at.value().address().is_v6()) {  // a link-local group needs its interface
    auto address = at.value().address().to_v6();
    address.scope_id(index.value());
    at = udp::endpoint(address, group.port);
  }
  udp::socket socket(io);
  boost::system::error_code ec;
  socket.open(at.value().protocol(), ec);
  if (!ec) socket.set_option(asio::socket_base::reuse_address(true), ec);
  // Bound to the group's address, so that other datagrams to the port are not read.
  if (!ec) socket.bind(at.value(), ec);
  if (!ec) socket.non_blocking(true, ec);
  if (ec) return makeError(ec);
  group_req join{};
  join.gr_interface = index.value();
  std::memcpy(&join.gr_group, at.value().data(), at.value().size());
  const int level = at.value().address().is_v6() ? IPPROTO_IPV6 : IPPROTO_IP;
  if (::setsockopt(socket.native_handle(), level, MCAST_JOIN_GROUP, &join, sizeof join) != 0)
    return makeError({errno, boost::system::system_category()});
  enlargeBuffer(socket);
  return std::shared_ptr<UdpSocket>(new UdpSocket(std::move(socket), clock, std::move(verifier)));
}

void UdpSocket::start(IsWanted is_wanted, OnDatagram on_datagram) {
  is_wanted_ = std::move(is_wanted);
  on_datagram_ = std::move(on_datagram);
  asio::co_spawn(
      socket_.get_executor(), [self = shared_from_this()] { return self->readAll(); },
      asio::detached);
}

void UdpSocket::close() {
  boost::system::error_code ignored;
  socket_.close(ignored);
}

void UdpSocket::send(std::span<const std::uint8_t> bytes) {
  boost::system::error_code ignored;
  socket_.send(asio::buffer(bytes.data(), bytes.size()), 0, ignored);
}

asio::awaitable<void> UdpSocket::readAll() {
  while (socket_.is_open()) {
    boost::system::error_code ec;
    co_await socket_.async_wait(udp::socket::wait_read,
                                asio::redirect_error(asio::use_awaitable, ec));
    if (ec || !readSome()) continue;
    co_await asio::post(socket_.get_executor(), asio::use_awaitable);
  }
}

bool UdpSocket::readSome() {
  for (int i = 0; i < kMostAtOnce && socket_.is_open(); ++i) {
    boost::system::error_code ec;
    const std::size_t size = socket_.receive(asio::buffer(buffer_), 0, ec);
    if (ec == asio::error::would_block) return false;
    if (ec) continue;  // such as "port unreachable": the selection judges the consequences
    bytes_ += size;
    const LocalTime now = clock_.now();
    const auto datagram = verifier_.verify(std::span(buffer_).first(size), now, is_wanted_);
    if (datagram) on_datagram_(*datagram, now);
  }
  return true;
}

}  // namespace hapticast::client
