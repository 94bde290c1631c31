// SPDX-License-Identifier: MIT
#include "common/transport/websocket_framing.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace hapticast {

namespace {

// RFC 6455, section 5.2.
constexpr std::uint8_t kFinal = 0x80, kReserved = 0x70, kOpcode = 0x0F;
constexpr std::uint8_t kMasked = 0x80, kLength = 0x7F;
constexpr std::uint8_t kTwoBytes = 126, kEightBytes = 127;  // lengths that follow in more bytes
constexpr std::uint8_t kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10;
// RFC 6455, section 7.4.1.
constexpr std::uint16_t kNormalClosure = 1000, kProtocolError = 1002, kMessageTooBig = 1009;

bool isControl(std::uint8_t opcode) { return opcode >= kClose; }

std::uint64_t readBigEndian(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t each : bytes) value = value << 8U | each;
  return value;
}

void addBigEndian(FramePrefix& out, std::uint64_t value, int bytes) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
    out.add(static_cast<std::uint8_t>(value >> static_cast<unsigned>(shift)));
}

void unmask(std::span<std::uint8_t> payload, std::span<const std::uint8_t> mask) {
  for (std::size_t i = 0; i < payload.size(); ++i) payload[i] ^= mask[i % mask.size()];
}

}  // namespace

void WebSocketFraming::feed(std::span<const std::uint8_t> chunk) {
  if (ended_ || error_) return;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  buffer_.insert(buffer_.end(), chunk.begin(), chunk.end());
}

WireError WebSocketFraming::fail(WireError error) {
  error_ = error;
  return error;
}

Result<std::optional<WebSocketFraming::Header>, WireError> WebSocketFraming::readLength(
    std::span<const std::uint8_t> bytes, Header header) {
  const std::uint8_t code = bytes[1] & kLength;
  const std::size_t more = code == kEightBytes ? 8 : code == kTwoBytes ? 2 : 0;
  header.size = 2 + more + kMaskBytes;
  if (bytes.size() < header.size) return std::optional<Header>();
  const std::uint64_t length = more > 0 ? readBigEndian(bytes.subspan(2, more)) : code;
  if (length >> 63U != 0) return malformed("a length of 2^63 or more");
  if ((more == 2 && length < kTwoBytes) || (more == 8 && length <= 0xFFFF))
    return malformed("a length in more bytes than it needs");
  header.payload = static_cast<std::size_t>(length);
  return std::optional(header);
}

Result<std::optional<WebSocketFraming::Header>, WireError> WebSocketFraming::readHeader(
    std::span<const std::uint8_t> bytes) const {
  if (bytes.size() < 2) return std::optional<Header>();
  Header header;
  header.opcode = bytes[0] & kOpcode;
  header.final = (bytes[0] & kFinal) != 0;
  if ((bytes[0] & kReserved) != 0) return malformed("a reserved bit, but no extension is in use");
  if ((bytes[1] & kMasked) == 0) return malformed("a frame of a client without a mask");
  if (isControl(header.opcode) && (!header.final || (bytes[1] & kLength) > kMostControlBytes))
    return malformed("a control frame in fragments or above 125 bytes");
  auto complete = readLength(bytes, header);
  if (!complete.ok() || !complete.value()) return complete;
  if (auto failure = check(*complete.value())) return std::move(*failure);
  return complete;
}

std::optional<WireError> WebSocketFraming::check(const Header& header) const {
  switch (header.opcode) {
    case kContinuation:
      if (fragments_ == 0) return malformed("a continuation without a begin");
      if (fragments_ >= kMostFragments) return malformed("a message in too many fragments");
      break;
    case kBinary:
      if (fragments_ > 0) return malformed("a second message inside the fragments of the first");
      break;
    case kText:
      return malformed("a text message; this stream has binary messages");
    case kClose:
    case kPing:
    case kPong:
      return std::nullopt;
    default:
      return malformed("a frame with an unknown opcode");
  }
  if (header.payload > limitBytes() - std::min(message_.size(), limitBytes())) {
    return WireError{ErrorCode::kTooLarge,
                     "a message of more than " + std::to_string(limitBytes()) + " bytes"};
  }
  if (header.final && message_.size() + header.payload == 0)
    return malformed("a message of length 0");
  return std::nullopt;
}

std::optional<WireError> WebSocketFraming::onControl(std::uint8_t opcode,
                                                     std::span<const std::uint8_t> payload) {
  if (opcode == kPing) {
    std::copy(payload.begin(), payload.end(), ping_.begin());
    ping_size_ = payload.size();
  } else if (opcode == kClose) {
    if (payload.size() == 1) return malformed("a close frame of one byte");
    ended_ = true;
  }
  return std::nullopt;
}

Result<std::optional<std::span<const std::uint8_t>>, WireError> WebSocketFraming::next() {
  std::optional<std::span<const std::uint8_t>> message;
  if (error_) return *error_;
  if (std::exchange(whole_, false)) message_.clear();
  while (!ended_) {
    const std::span<std::uint8_t> rest = std::span(buffer_).subspan(begin_);
    const auto read = readHeader(rest);
    if (!read.ok()) return fail(read.error());
    if (!read.value() || rest.size() - read.value()->size < read.value()->payload) return message;
    const Header& header = *read.value();
    const auto payload = rest.subspan(header.size, header.payload);
    unmask(payload, rest.subspan(header.size - kMaskBytes, kMaskBytes));
    begin_ += header.size + header.payload;
    if (isControl(header.opcode)) {
      if (auto failure = onControl(header.opcode, payload)) return fail(std::move(*failure));
      continue;
    }
    message = payload;
    if (header.final && fragments_ == 0) return message;
    message_.insert(message_.end(), payload.begin(), payload.end());
    ++fragments_;
    message.reset();
    if (!header.final) continue;
    fragments_ = 0;
    whole_ = true;
    message = message_;
    return message;
  }
  return message;
}

void WebSocketFraming::writePrefix(std::size_t payload_bytes, FramePrefix& out) {
  out.size = 0;
  if (ping_size_) {
    out.add(kFinal | kPong);
    out.add(static_cast<std::uint8_t>(*ping_size_));
    std::copy_n(ping_.begin(), *ping_size_,
                out.bytes.begin() + static_cast<std::ptrdiff_t>(out.size));
    out.size += *ping_size_;
    ping_size_.reset();
  }
  out.add(kFinal | kBinary);
  if (payload_bytes < kTwoBytes) {
    out.add(static_cast<std::uint8_t>(payload_bytes));
  } else if (payload_bytes <= 0xFFFF) {
    out.add(kTwoBytes);
    addBigEndian(out, payload_bytes, 2);
  } else {
    out.add(kEightBytes);
    addBigEndian(out, payload_bytes, 8);
  }
}

FramePrefix WebSocketFraming::makeFarewell() const {
  std::uint16_t status = kNormalClosure;
  if (error_) status = error_->code == ErrorCode::kTooLarge ? kMessageTooBig : kProtocolError;
  FramePrefix frame;
  frame.add(kFinal | kClose);
  frame.add(2);
  addBigEndian(frame, status, 2);
  return frame;
}

}  // namespace hapticast
