// SPDX-License-Identifier: MIT
#include "common/transport/datagram.hpp"

#include <algorithm>
#include <type_traits>

#include "common/wire_limits.hpp"

namespace hapticast {

namespace {

constexpr std::size_t kBodyHeaderBytes = kDatagramHeaderBytes - kTokenBytes;

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

/// Splits the content of a sealed datagram: `content` begins with the counter. Returns false if it
/// is too short, or if the datagram is a probe.
bool readSeal(Datagram& datagram, std::span<const std::uint8_t> content) noexcept {
  if (content.size() < kSealBytes || datagram.header.probe()) return false;
  datagram.counter = Reader{content}.next<std::uint64_t>();
  datagram.readable = datagram.signed_bytes.first(kBodyHeaderBytes + kSealCounterBytes);
  datagram.sealed = content.subspan(kSealCounterBytes);
  return true;
}

template <class Number>
std::uint8_t* write(Number number, std::uint8_t* out) noexcept {
  const auto bits = static_cast<std::uint64_t>(number);
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    *out++ = static_cast<std::uint8_t>(bits >> (8 * i));
  return out;
}

bool isSensible(const DatagramHeader& header, std::size_t datagram_bytes) noexcept {
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
  datagram.key_id = in.next<std::uint8_t>();
  header.epoch = in.next<std::uint32_t>();
  header.frame = in.next<std::uint64_t>();
  header.media_time = MediaTime(Duration(in.next<std::int64_t>()));
  header.part = in.next<std::uint16_t>();
  header.parts = in.next<std::uint16_t>();
  if (!isSensible(header, bytes.size())) return std::nullopt;
  datagram.signed_bytes = bytes.subspan(kTokenBytes, bytes.size() - kTokenBytes - kSignatureBytes);
  datagram.signature = bytes.last(kSignatureBytes);
  const auto content = bytes.subspan(kDatagramHeaderBytes, bytes.size() - kBeside);
  if (datagram.key_id == kPlainKeyId) {
    datagram.payload = content;
  } else if (!readSeal(datagram, content)) {
    return std::nullopt;
  }
  return datagram;
}

std::vector<std::uint8_t> signedBody(const DatagramHeader& header,
                                     std::span<const std::uint8_t> payload, SigningKey& key,
                                     SealingKey* seal) {
  std::vector<std::uint8_t> body;
  body.reserve(kBodyHeaderBytes + payload.size() + kSealBytes + kSignatureBytes);
  body.resize(kBodyHeaderBytes);
  std::uint8_t* out = body.data();
  out = write(header.stream, out);
  out = write(seal != nullptr ? seal->id() : kPlainKeyId, out);
  out = write(header.epoch, out);
  out = write(header.frame, out);
  out = write(header.media_time.time_since_epoch().count(), out);
  out = write(header.part, out);
  write(header.parts, out);
  if (seal != nullptr) {
    seal->seal(body, payload);
  } else {
    body.insert(body.end(), payload.begin(), payload.end());
  }
  const Signature signature = key.sign(body);
  body.insert(body.end(), signature.begin(), signature.end());
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
