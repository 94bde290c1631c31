// SPDX-License-Identifier: MIT
// Reads foxglove.RawImage, foxglove.CompressedImage and foxglove.CameraCalibration (protobuf). A
// protobuf message is a list of fields: a key (varint: 8 times the number of the field, plus its
// wire type) and a value. Wire types: 0 varint, 1 eight bytes, 2 a length and bytes, 5 four bytes.
// A varint has 7 bits in each byte, the lowest first. Unknown fields are skipped. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/result.hpp"
#include "server/source/recording/message_types.hpp"

namespace hapticast::server {

// As readImageMessage() and readCameraMessage(), for these types.
[[nodiscard]] Result<ImageMessage> readFoxgloveImage(MessageType type,
                                                     std::span<const std::uint8_t> bytes);
[[nodiscard]] std::optional<CameraMessage> readFoxgloveCamera(std::span<const std::uint8_t> bytes);

}  // namespace hapticast::server
