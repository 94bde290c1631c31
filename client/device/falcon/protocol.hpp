// SPDX-License-Identifier: MIT
// The Novint Falcon's run mode: a frame of 16 characters goes out, one comes back. Pure: bytes in,
// values out. Thread: any, one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace hapticast::client {

/// Motors, encoders and homed bits in this order: top, right, left, seen from the front.
struct FalconRequest {
  std::array<int, 3> motors{};  ///< counts; what goes out is within +-kMostMotorCounts
  bool homing = true;           ///< in every frame: without it the device forgets where it is
  std::uint8_t lights = 0;      ///< bits of FalconLight
  bool operator==(const FalconRequest&) const = default;
};
struct FalconLight {
  static constexpr std::uint8_t kGreen = 0x02;
  static constexpr std::uint8_t kBlue = 0x04;
  static constexpr std::uint8_t kRed = 0x08;
};

struct FalconReply {
  std::array<int, 3> encoders{};
  std::uint8_t buttons = 0;  ///< bits of FalconButton
  std::uint8_t homed = 0;    ///< a bit an axis
  bool operator==(const FalconReply&) const = default;
};
struct FalconButton {
  static constexpr int kRight = 0;
  static constexpr int kForward = 1;
  static constexpr int kCentre = 2;
  static constexpr int kLeft = 3;
};

inline constexpr std::uint8_t kAllHomed = 0x07;
/// The drivers saturate here, though the field has 16 bits.
inline constexpr int kMostMotorCounts = 4095;

using FalconFrame = std::array<std::uint8_t, 16>;

FalconFrame encode(const FalconRequest& request) noexcept;

/// Finds replies in a stream of bytes, however it is cut, and starts anew at the next frame after
/// anything that is none. There is no checksum: a nibble that turned into another one stays
/// undetected here.
class FalconParser {
 public:
  /// The reply that this byte completes.
  std::optional<FalconReply> push(std::uint8_t byte) noexcept;
  /// How often a frame broke off, or bytes stood between two.
  [[nodiscard]] std::uint64_t resyncs() const noexcept { return resyncs_; }
  /// What was begun is forgotten.
  void restart() noexcept { filled_ = 0; }

 private:
  [[nodiscard]] bool fits(std::uint8_t byte) const noexcept;

  FalconFrame frame_{};
  std::size_t filled_ = 0;
  bool astray_ = false;  // since the last whole frame
  std::uint64_t resyncs_ = 0;
};

}  // namespace hapticast::client
