// SPDX-License-Identifier: MIT
// Messages as recordings have them (proto/recording.md). A recording has the content of a message
// of the wire: the bytes of a HapticFrame in place of a Message with a frame. Thread: any.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "common/protocol/messages.hpp"

namespace hapticast {

/// Returns the bytes of the content of an encoded message, for example of a HapticFrame; empty if
/// it has none. Valid as long as `message`.
[[nodiscard]] std::span<const std::uint8_t> findContent(std::span<const std::uint8_t> message);

/// Decode the contents of recorded messages, as decode() does.
[[nodiscard]] Result<CodedFrame, WireError> decodeFrameContent(std::span<const std::uint8_t> bytes);
[[nodiscard]] Result<StreamDescription, WireError> decodeDescriptionContent(
    std::span<const std::uint8_t> bytes);

/// Returns the bytes of a foxglove.CompressedImage with this picture.
[[nodiscard]] std::vector<std::uint8_t> encodePictureContent(const VideoFrame& video);
/// Decodes a foxglove.CompressedImage with a JPEG. Returns it with epoch and id 0.
[[nodiscard]] Result<VideoFrame, WireError> decodePictureContent(
    std::span<const std::uint8_t> bytes);

/// Levels of lines of a log, with the numbers of foxglove.Log.
enum class LogLevel : std::uint8_t { kDebug = 1, kInfo, kWarning, kError };
/// Returns the bytes of a foxglove.Log. Characters that are no UTF-8 are replaced.
[[nodiscard]] std::vector<std::uint8_t> encodeLogContent(std::uint64_t time_ns, LogLevel level,
                                                         std::string_view text,
                                                         std::string_view program);

}  // namespace hapticast
