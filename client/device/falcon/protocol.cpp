// SPDX-License-Identifier: MIT
#include "client/device/falcon/protocol.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {

// A nibble is a letter from 'A' to 'P'. The flags have up to 7 bits and also begin at 'A'.
constexpr std::uint8_t kBegin = '<';
constexpr std::uint8_t kEnd = '>';
constexpr std::uint8_t kNibbleZero = 'A';
constexpr std::uint8_t kLastNibble = kNibbleZero + 0x0F;
constexpr std::uint8_t kLastFlags = kNibbleZero + 0x7F;
constexpr std::size_t kFlagsAt = 13;
constexpr std::size_t kUnusedAt = 14;
constexpr std::size_t kEndAt = 15;
constexpr std::uint8_t kHomingFlag = 0x01;
constexpr std::uint8_t kButtonBits = 0x0F;
constexpr unsigned kHomedShift = 4;

/// Index of a nibble of motor or encoder `axis`, the least significant first.
constexpr std::size_t nibbleIndex(std::size_t axis, std::size_t nibble) noexcept {
  return 1 + 4 * axis + nibble;
}

int decodeEncoder(const FalconFrame& frame, std::size_t axis) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < 4; ++i)
    bits |= static_cast<unsigned>(frame[nibbleIndex(axis, i)] - kNibbleZero) << (4 * i);
  return static_cast<std::int16_t>(bits);
}

}  // namespace

FalconFrame encode(const FalconRequest& request) noexcept {
  FalconFrame frame{};
  frame[0] = kBegin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int counts = std::clamp(request.motors[axis], -kMostMotorCounts, kMostMotorCounts);
    const auto bits = static_cast<std::uint16_t>(counts);
    for (std::size_t i = 0; i < 4; ++i)
      frame[nibbleIndex(axis, i)] =
          static_cast<std::uint8_t>(kNibbleZero + (bits >> (4 * i) & 0x0FU));
  }
  const unsigned flags = request.lights | (request.homing ? kHomingFlag : 0U);
  frame[kFlagsAt] = static_cast<std::uint8_t>(kNibbleZero + flags);
  frame[kUnusedAt] = kNibbleZero;
  frame[kEndAt] = kEnd;
  return frame;
}

bool FalconParser::fits(std::uint8_t byte) const noexcept {
  if (filled_ == 0) return byte == kBegin;
  if (filled_ < kFlagsAt) return byte >= kNibbleZero && byte <= kLastNibble;
  if (filled_ == kFlagsAt) return byte >= kNibbleZero && byte <= kLastFlags;
  return filled_ == kUnusedAt || byte == kEnd;
}

std::optional<FalconReply> FalconParser::push(std::uint8_t byte) noexcept {
  if (!fits(byte)) {
    if (!astray_) ++resyncs_;
    astray_ = true;
    // The unused character may have any value: it was the begin of the next frame.
    filled_ = filled_ == kEndAt && frame_[kUnusedAt] == kBegin ? 1 : 0;
    if (!fits(byte)) {
      filled_ = 0;
      if (byte != kBegin) return std::nullopt;
    }
  }
  frame_[filled_++] = byte;
  if (filled_ < frame_.size()) return std::nullopt;
  filled_ = 0;
  astray_ = false;
  FalconReply reply;
  for (std::size_t axis = 0; axis < 3; ++axis) reply.encoders[axis] = decodeEncoder(frame_, axis);
  const auto flags = static_cast<std::uint8_t>(frame_[kFlagsAt] - kNibbleZero);
  reply.buttons = flags & kButtonBits;
  reply.homed = static_cast<std::uint8_t>(flags >> kHomedShift);
  return reply;
}

}  // namespace hapticast::client
