// SPDX-License-Identifier: MIT
// Opens files and network streams with FFmpeg's libraries, with limits on their size and number of
// tracks. Thread: one.
#pragma once

extern "C" {
#include <libavformat/avformat.h>
}

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/source/picture/picture_size.hpp"
#include "server/source/video/video_input.hpp"

namespace hapticast::server {

/// Largest number of streams of a file.
inline constexpr unsigned kMostStreams = 16;
/// Largest picture to decode: the largest one that a source reads, with a codec's padding.
inline constexpr std::int64_t kMostDecoded_px = kMostPixels + 64LL * 2 * kMostSide_px;

template <typename T, void (*release)(T**)>
struct LibavDelete {
  void operator()(T* object) const { release(&object); }
};
using FormatPtr =
    std::unique_ptr<AVFormatContext, LibavDelete<AVFormatContext, avformat_close_input>>;

/// Opens the file and reads its header. Throws as VideoFile's constructor.
[[nodiscard]] FormatPtr openFormat(const std::string& file);
/// Opens the stream and reads as much as its description needs. `stream.give_up` must outlive the
/// result. Throws as VideoFile's constructor.
[[nodiscard]] FormatPtr openFormat(const NetworkStream& stream);

/// Throws the NoVideoError of a file or stream with this name.
[[noreturn]] void throwNoVideo(const std::string& name, bool live);

}  // namespace hapticast::server
