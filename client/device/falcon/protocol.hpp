// SPDX-License-Identifier: MIT
// Wire protocol of the Novint Falcon while its firmware runs. Each request and each reply is a
// frame of 16 characters. The functions convert between these characters and values. They do not
// access the device.
// Thread: any, one at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace hapticast::client {

/// A request to the device. Motors, encoders and homed bits have this order: top, right, left, seen
/// from the front.
struct FalconRequest {
  std::array<int, 3> motors{};  ///< motor counts; encode() clamps them to ±kMostMotorCounts
  bool homing = true;           ///< must be set in every request, or the device loses its position
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
  std::uint8_t homed = 0;    ///< one bit for each axis whose position the device has found
  bool operator==(const FalconReply&) const = default;
};
struct FalconButton {
  static constexpr int kRight = 0;
  static constexpr int kForward = 1;
  static constexpr int kCentre = 2;
  static constexpr int kLeft = 3;
};

inline constexpr std::uint8_t kAllHomed = 0x07;
/// Largest motor count of a request. The motor drivers of the device saturate at this value,
/// although the protocol has 16 bits for it.
inline constexpr int kMostMotorCounts = 4095;

using FalconFrame = std::array<std::uint8_t, 16>;

/// Returns the 16 characters of a request.
FalconFrame encode(const FalconRequest& request) noexcept;

/// Parser that finds the replies in a stream of bytes. The bytes may arrive in pieces of any size.
/// After an error it continues at the next frame. The protocol has no checksum, so the parser
/// cannot detect a changed character.
class FalconParser {
 public:
  /// Processes the next byte of the stream. Returns a reply if the byte completes one, else
  /// nullopt.
  std::optional<FalconReply> push(std::uint8_t byte) noexcept;
  /// Returns the number of errors in the stream: broken frames, and gaps with other bytes between
  /// two frames.
  [[nodiscard]] std::uint64_t resyncs() const noexcept { return resyncs_; }
  /// Drops an incomplete frame. Call it when a new stream of bytes begins.
  void restart() noexcept { filled_ = 0; }

 private:
  [[nodiscard]] bool fits(std::uint8_t byte) const noexcept;

  FalconFrame frame_{};
  std::size_t filled_ = 0;
  bool astray_ = false;  // other bytes have arrived since the last complete frame
  std::uint64_t resyncs_ = 0;
};

}  // namespace hapticast::client
