// SPDX-License-Identifier: MIT
#include "common/transport/framing.hpp"

#include <algorithm>
#include <string>

namespace hapticast {

LengthPrefix lengthPrefix(std::size_t payload_bytes) {
  LengthPrefix prefix{};
  for (std::size_t i = 0; i < kPrefixBytes; ++i) {
    prefix[i] = static_cast<std::uint8_t>(payload_bytes >> (8 * i));
  }
  return prefix;
}

void LengthFraming::writePrefix(std::size_t payload_bytes, FramePrefix& out) {
  const LengthPrefix length = lengthPrefix(payload_bytes);
  std::copy(length.begin(), length.end(), out.bytes.begin());
  out.size = length.size();
}

void LengthFraming::feed(std::span<const std::uint8_t> chunk) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  buffer_.insert(buffer_.end(), chunk.begin(), chunk.end());
}

Result<std::optional<std::span<const std::uint8_t>>, WireError> LengthFraming::next() {
  const std::span<const std::uint8_t> rest = std::span(buffer_).subspan(begin_);
  std::optional<std::span<const std::uint8_t>> message;
  if (rest.size() < kPrefixBytes) return message;
  std::size_t length = 0;
  for (std::size_t i = 0; i < kPrefixBytes; ++i) length |= std::size_t{rest[i]} << (8 * i);
  if (length == 0) return malformed("a message of length 0");
  if (length > limitBytes()) {
    return WireError{ErrorCode::kTooLarge, "a message of " + std::to_string(length) +
                                               " bytes, at most " + std::to_string(limitBytes()) +
                                               " are allowed here"};
  }
  if (rest.size() - kPrefixBytes < length) return message;
  begin_ += kPrefixBytes + length;
  message = rest.subspan(kPrefixBytes, length);
  return message;
}

}  // namespace hapticast
