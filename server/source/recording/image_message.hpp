// SPDX-License-Identifier: MIT
// Messages of recordings that have images or the intrinsics of a camera. ROS 2 writes them as CDR
// (sensor_msgs), Foxglove's programs as protobuf (foxglove.*). The functions read the fields and
// check them; message_picture.hpp decodes the picture. The bytes are not trusted. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/recording/mcap_records.hpp"
#include "common/result.hpp"
#include "server/source/recording/message_types.hpp"

namespace hapticast::server {

/// Returns the type of the messages of `channel`; nullopt: one that the server does not read.
[[nodiscard]] std::optional<MessageType> findType(const McapChannel& channel);

/// Returns whether messages of `type` have intrinsics, not an image.
[[nodiscard]] bool isCameraType(MessageType type);

/// Returns the image in the message `bytes` of `type`, or its problem as a phrase ("has a message
/// that is cut off"). Requires a type with images. Limits of the picture are not checked yet.
[[nodiscard]] Result<ImageMessage> readImageMessage(MessageType type,
                                                    std::span<const std::uint8_t> bytes);

/// Returns the intrinsics in the message `bytes` of `type`; nullopt if it is damaged, or states no
/// focal length from 1 to 100000 px, which means that the camera is not calibrated. Requires a type
/// with intrinsics.
[[nodiscard]] std::optional<CameraMessage> readCameraMessage(MessageType type,
                                                             std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
