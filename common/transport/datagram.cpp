// SPDX-License-Identifier: MIT
#include "common/transport/datagram.hpp"

#include <algorithm>
#include <type_traits>

#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

/// Id of the key that seals a datagram. No other id exists yet.
constexpr std::uint8_t kPlain = 0;

/// Reads successive little-endian numbers.
struct Reader {
  std::span<const std::uint8_t> rest;

  template <class Number>
  Number next() noexcept {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) bits |= std::uint64_t{rest[i]} << (8 * i);
    rest = rest.subspan(sizeof(Number));
    return static_cast<Number>(bits);
  }
};

template <class Number>
std::uint8_t* write(Number number, std::uint8_t* out) noexcept {
  const auto bits = static_cast<std::uint64_t>(number);
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    *out++ = static_cast<std::uint8_t>(bits >> (8 * i));
  return out;
}

bool sensible(const DatagramHeader& header, std::size_t datagram_bytes) noexcept {
  const std::int64_t ns = header.media_time.time_since_epoch().count();
  if (ns < -limits::kTime_ns || ns > limits::kTime_ns) return false;
  return header.probe() ? header.part == 0 && datagram_bytes == kMostDatagramBytes
                        : header.part < header.parts;
}

}  // namespace

std::optional<Datagram> readDatagram(std::span<const std::uint8_t> bytes) noexcept {
  constexpr std::size_t kBeside = kDatagramHeaderBytes + kSignatureBytes;
  if (bytes.size() < kBeside || bytes.size() > kMostDatagramBytes) return std::nullopt;
  Datagram datagram;
  Reader in{bytes};
  datagram.token = in.next<std::uint64_t>();
  DatagramHeader& header = datagram.header;
  header.stream = in.next<std::uint32_t>();
  if (in.next<std::uint8_t>() != kPlain) return std::nullopt;
  header.epoch = in.next<std::uint32_t>();
  header.frame = in.next<std::uint64_t>();
  header.media_time = MediaTime(Duration(in.next<std::int64_t>()));
  header.part = in.next<std::uint16_t>();
  header.parts = in.next<std::uint16_t>();
  if (!sensible(header, bytes.size())) return std::nullopt;
  datagram.payload = bytes.subspan(kDatagramHeaderBytes, bytes.size() - kBeside);
  datagram.signed_bytes = bytes.subspan(kTokenBytes, bytes.size() - kTokenBytes - kSignatureBytes);
  datagram.signature = bytes.last(kSignatureBytes);
  return datagram;
}

std::vector<std::uint8_t> signedBody(const DatagramHeader& header,
                                     std::span<const std::uint8_t> payload, SigningKey& key) {
  const std::size_t to_sign = kDatagramHeaderBytes - kTokenBytes + payload.size();
  std::vector<std::uint8_t> body(to_sign + kSignatureBytes);
  std::uint8_t* out = body.data();
  out = write(header.stream, out);
  out = write(kPlain, out);
  out = write(header.epoch, out);
  out = write(header.frame, out);
  out = write(header.media_time.time_since_epoch().count(), out);
  out = write(header.part, out);
  out = write(header.parts, out);
  out = std::copy(payload.begin(), payload.end(), out);
  const Signature signature = key.sign(std::span(body).first(to_sign));
  std::copy(signature.begin(), signature.end(), out);
  return body;
}

std::vector<std::uint8_t> probeBody(std::uint32_t stream, SigningKey& key) {
  DatagramHeader header;
  header.stream = stream;
  const std::vector<std::uint8_t> padding(kMostPieceBytes + kSealBytes);
  return signedBody(header, padding, key);
}

TokenBytes tokenBytes(std::uint64_t token) noexcept {
  TokenBytes bytes{};
  write(token, bytes.data());
  return bytes;
}

EchoBytes echoBytes(const Echo& echo) noexcept {
  EchoBytes bytes{};
  write(echo.stream, write(echo.token, bytes.data()));
  return bytes;
}

std::optional<Echo> readEcho(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != kEchoBytes) return std::nullopt;
  Reader in{bytes};
  Echo echo;
  echo.token = in.next<std::uint64_t>();
  echo.stream = in.next<std::uint32_t>();
  return echo;
}

}  // namespace hapticast
