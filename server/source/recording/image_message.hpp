// SPDX-License-Identifier: MIT
// Messages of recordings that have images or the intrinsics of a camera. ROS 2 writes them as CDR
// (sensor_msgs), Foxglove's programs as protobuf (foxglove.*). The functions read the fields and
// check them; message_picture.hpp decodes the picture. The bytes are not trusted. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "common/recording/mcap_records.hpp"
#include "common/result.hpp"
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

/// Returns the type of the messages of `channel`; nullopt: one that the server does not read.
[[nodiscard]] std::optional<MessageType> findType(const McapChannel& channel);

/// Returns whether messages of `type` have intrinsics, not an image.
[[nodiscard]] bool isCameraType(MessageType type);

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

/// Returns the image in the message `bytes` of `type`, or its problem as a phrase ("has a message
/// that is cut off"). Requires a type with images. Limits of the picture are not checked yet.
[[nodiscard]] Result<ImageMessage> readImageMessage(MessageType type,
                                                    std::span<const std::uint8_t> bytes);

/// Intrinsics of a camera for pictures of a size.
struct CameraMessage {
  CameraModel camera;
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
};

/// Returns the intrinsics in the message `bytes` of `type`; nullopt if it is damaged, or states no
/// focal length from 1 to 100000 px, which means that the camera is not calibrated. Requires a type
/// with intrinsics.
[[nodiscard]] std::optional<CameraMessage> readCameraMessage(MessageType type,
                                                             std::span<const std::uint8_t> bytes);

// Shared by the readers of both forms.

/// Returns the time stamp of a message in nanoseconds, or 0 if it is none.
[[nodiscard]] std::int64_t toStamp_ns(std::int64_t seconds, std::int64_t nanoseconds);

/// Returns `camera` with the intrinsics of the matrix `k`: fx, 0, cx; 0, fy, cy; 0, 0, 1 (rows, the
/// convention of OpenCV). Returns nullopt if they are out of range.
[[nodiscard]] std::optional<CameraMessage> withMatrix(CameraMessage camera,
                                                      std::span<const double, 9> k);

}  // namespace hapticast::server
