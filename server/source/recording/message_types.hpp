// SPDX-License-Identifier: MIT
// What the server reads in messages of recordings, for the readers of both forms. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Types of messages that the server reads.
enum class MessageType : std::uint8_t {
  kRosImage,
  kRosCompressedImage,
  kRosCameraInfo,
  kFoxgloveImage,
  kFoxgloveCompressedImage,
  kFoxgloveCalibration,
};

/// An image as its message has it. Texts and data are valid as long as the bytes of the message.
struct ImageMessage {
  std::int64_t stamp_ns = 0;  ///< time of the capture on the clock of the recording; 0: none
  std::string_view frame_id;  ///< name of the camera's frame of reference; empty: none
  /// Encoding of raw pixels ("rgb8"), or the format of a compressed image ("jpeg").
  std::string_view encoding;
  bool is_compressed = false;
  // Only of raw pixels.
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  std::uint32_t row_bytes = 0;
  bool big_endian = false;
  std::span<const std::uint8_t> data;
};

/// Intrinsics of a camera for pictures of a size.
struct CameraMessage {
  CameraModel camera;
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
};

/// Returns the time stamp of a message in nanoseconds, or 0 if it is none.
[[nodiscard]] std::int64_t toStamp_ns(std::int64_t seconds, std::int64_t nanoseconds);

/// Returns `camera` with the intrinsics of the matrix `k`: fx, 0, cx; 0, fy, cy; 0, 0, 1 (rows, the
/// convention of OpenCV). Returns nullopt if they are out of range.
[[nodiscard]] std::optional<CameraMessage> withMatrix(CameraMessage camera,
                                                      std::span<const double, 9> k);

}  // namespace hapticast::server
