// SPDX-License-Identifier: MIT
// What differs between FFmpeg 5.1 (Debian 12) and 7.1 (Debian 13) stands here: a stream's side
// data. Thread: any.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <cstddef>
#include <cstdint>

namespace hapticast::server {

/// Returns the nine numbers of the matrix by which a player turns the pictures; nullptr if the
/// stream has none. The stream owns them.
[[nodiscard]] inline const std::int32_t* findDisplayMatrix(const AVStream& stream) {
  const std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
#if LIBAVFORMAT_VERSION_INT >= AV_VERSION_INT(60, 15, 100)
  const AVCodecParameters& codec = *stream.codecpar;
  const AVPacketSideData* const data = av_packet_side_data_get(
      codec.coded_side_data, codec.nb_coded_side_data, AV_PKT_DATA_DISPLAYMATRIX);
  if (data != nullptr) {
    bytes = data->data;
    size = data->size;
  }
#else
  bytes = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, &size);
#endif
  if (size < 9 * sizeof(std::int32_t)) return nullptr;
  return reinterpret_cast<const std::int32_t*>(bytes);
}

}  // namespace hapticast::server
