// SPDX-License-Identifier: MIT
// Owners of libav's objects, and its errors as text. Thread: one at a time for each object.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <array>
#include <memory>
#include <new>
#include <string>

namespace hapticast::media {

/// Deleter for std::unique_ptr. `kFree`: the function of libav that frees a T; it has a T** as its
/// parameter.
template <class T, void (*kFree)(T**)>
struct LibavDelete {
  void operator()(T* object) const { kFree(&object); }
};
struct ScalerDelete {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
/// Frees a muxer and closes its file. Writes no trailer.
struct MuxerDelete {
  void operator()(AVFormatContext* muxer) const {
    avio_closep(&muxer->pb);
    avformat_free_context(muxer);
  }
};
using CodecPtr = std::unique_ptr<AVCodecContext, LibavDelete<AVCodecContext, avcodec_free_context>>;
using PacketPtr = std::unique_ptr<AVPacket, LibavDelete<AVPacket, av_packet_free>>;
using PicturePtr = std::unique_ptr<AVFrame, LibavDelete<AVFrame, av_frame_free>>;
using ScalerPtr = std::unique_ptr<SwsContext, ScalerDelete>;
using MuxerPtr = std::unique_ptr<AVFormatContext, MuxerDelete>;

/// Returns `object`. Throws std::bad_alloc if it is null.
template <class T>
T* requireMemory(T* object) {
  if (object == nullptr) throw std::bad_alloc();
  return object;
}

/// Returns a picture with the format and size of `codec`. Throws std::bad_alloc.
inline PicturePtr makePicture(const AVCodecContext& codec) {
  PicturePtr picture(requireMemory(av_frame_alloc()));
  picture->format = codec.pix_fmt;
  picture->width = codec.width;
  picture->height = codec.height;
  if (av_frame_get_buffer(picture.get(), 0) < 0) throw std::bad_alloc();
  return picture;
}

/// Returns libav's text for `error`, for example "No space left on device".
inline std::string describe(int error) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

}  // namespace hapticast::media
