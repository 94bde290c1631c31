// SPDX-License-Identifier: MIT
// Limits of the protocol (table in proto/README.md). The decoder checks all data against them.
// Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>

namespace hapticast::limits {

inline constexpr float kLowestHeight_mm = -1.0F;  ///< below 0 only because of rounding
inline constexpr float kHighestHeight_mm = 1000.0F;
inline constexpr double kPosition_mm = 1e4;
inline constexpr double kVelocity_mm_s = 1e6;
inline constexpr double kAcceleration_mm_s2 = 1e8;
inline constexpr double kAngle_rad = 1e4;
inline constexpr double kAngularVelocity_rad_s = 1e4;
inline constexpr double kStiffness_N_mm = 1e3;
inline constexpr double kDamping_Ns_m = 1e3;
inline constexpr double kFriction = 1.5;  ///< for comparison: rubber on dry stone has about 1
/// Limit of each side of the workspace, and of K in Eq. 3.
inline constexpr double kWorkspace_mm = 1000.0;
inline constexpr double kMinMass_kg = 1e-6;
inline constexpr double kMass_kg = 1000.0;
inline constexpr double kMinFps = 1.0;
inline constexpr double kMaxFps = 240.0;
/// Largest magnitude of a time: 31 years.
inline constexpr std::int64_t kTime_ns = 1'000'000'000'000'000'000;
inline constexpr std::int64_t kLatency_ns = 10'000'000'000;
/// Largest error that a server may state for its clock. A larger one is of no use.
inline constexpr std::int64_t kClockError_ns = 10'000'000'000;
/// Largest number of bytes (UTF-8) of a client's name. The three limits below are of the same kind.
inline constexpr std::size_t kClientName = 64;
inline constexpr std::size_t kStreamName = 256;
inline constexpr std::size_t kErrorText = 512;
inline constexpr std::size_t kGroupAddress = 64;
inline constexpr std::size_t kAccessToken = 256;  ///< bytes
inline constexpr std::int64_t kKeyGrace_ms = 60'000;
inline constexpr double kClip_s = 1e6;
/// Speeds of playback, recorded seconds a second.
inline constexpr double kLeastSpeed = 0.1, kMostSpeed = 4.0;
/// Largest number of times that a datagram is sent.
inline constexpr std::uint32_t kMostCopies = 4;
inline constexpr std::size_t kJpeg = 4U << 20U;
/// Largest message with a picture: the JPEG and the other fields, which are at most 64 bytes.
inline constexpr std::size_t kPictureMessage = kJpeg + 64;
inline constexpr std::size_t kPicturePart = 64U << 10U;
inline constexpr std::uint32_t kReceiptHeld_us = 10'000'000;

}  // namespace hapticast::limits
