// SPDX-License-Identifier: MIT
// Wire protocol of the Novint Falcon's run mode: each request and each reply is a frame of 16
// characters. Bytes in, values out.
// Thread: any, one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace hapticast::client {

/// Order of motors, encoders and homed bits: top, right, left, seen from the front.
struct FalconRequest {
  std::array<int, 3> motors{};  ///< counts; encode() limits them to ±kMostMotorCounts
  bool homing = true;           ///< set in every frame: without it the device loses its position
  std::uint8_t lights = 0;      ///< bits of FalconLight
  bool operator==(const FalconRequest&) const = default;
};
struct FalconLight {
  static constexpr std::uint8_t kGreen = 0x02;
  static constexpr std::uint8_t kBlue = 0x04;
  static constexpr std::uint8_t kRed = 0x08;
};

/// A reply of the device.
struct FalconReply {
  std::array<int, 3> encoders{};
  std::uint8_t buttons = 0;  ///< bits of FalconButton
  std::uint8_t homed = 0;    ///< one bit for each axis
  bool operator==(const FalconReply&) const = default;
};
struct FalconButton {
  static constexpr int kRight = 0;
  static constexpr int kForward = 1;
  static constexpr int kCentre = 2;
  static constexpr int kLeft = 3;
};

inline constexpr std::uint8_t kAllHomed = 0x07;
/// The drivers saturate at this value, although the field has 16 bits.
inline constexpr int kMostMotorCounts = 4095;

using FalconFrame = std::array<std::uint8_t, 16>;

/// Encodes a request.
FalconFrame encode(const FalconRequest& request) noexcept;

/// Parser of replies in a stream of bytes, with any segmentation. After an error it continues at
/// the next frame. The protocol has no checksum, so a changed nibble remains undetected here.
class FalconParser {
 public:
  /// Returns the reply that this byte completes; nullopt if there is none.
  std::optional<FalconReply> push(std::uint8_t byte) noexcept;
  /// Number of broken frames, and of gaps with stray bytes.
  [[nodiscard]] std::uint64_t resyncs() const noexcept { return resyncs_; }
  /// Drops a partial frame.
  void restart() noexcept { filled_ = 0; }

 private:
  [[nodiscard]] bool fits(std::uint8_t byte) const noexcept;

  FalconFrame frame_{};
  std::size_t filled_ = 0;
  bool astray_ = false;  // stray bytes since the last complete frame
  std::uint64_t resyncs_ = 0;
};

}  // namespace hapticast::client
