// SPDX-License-Identifier: MIT
// PNG files of 3 x 8 bits.
extern "C" {
#include <libavutil/opt.h>
}

#include <cstdint>
#include <stdexcept>

#include "common/media/module/encoders.hpp"
#include "common/media/module/libav.hpp"

namespace hapticast::media {

namespace {

/// Throws if `result` is an error.
void requireSuccess(int result) {
  if (result < 0)
    throw std::runtime_error("FFmpeg cannot encode a PNG file (" + describe(result) + ")");
}

CodecPtr openPngCodec(int width_px, int height_px) {
  const AVCodec* const kind = avcodec_find_encoder(AV_CODEC_ID_PNG);
  if (kind == nullptr) requireSuccess(AVERROR_ENCODER_NOT_FOUND);
  CodecPtr codec(requireMemory(avcodec_alloc_context3(kind)));
  codec->width = width_px;
  codec->height = height_px;
  codec->pix_fmt = AV_PIX_FMT_RGB24;
  codec->time_base = {1, 1};
  // Drawings become a third smaller if each row is stored as its difference from the row above.
  requireSuccess(av_opt_set(codec.get(), "pred", "up", AV_OPT_SEARCH_CHILDREN));
  requireSuccess(avcodec_open2(codec.get(), kind, nullptr));
  return codec;
}

/// Copies `from` into `to`, with red first.
void copyPixels(const BgrPixels& from, AVFrame& to) {
  for (int v = 0; v < from.height_px; ++v) {
    const std::uint8_t* bgr = from.data + v * from.stride_bytes;
    std::uint8_t* rgb = to.data[0] + std::ptrdiff_t{v} * to.linesize[0];
    for (int u = 0; u < from.width_px; ++u, bgr += 3, rgb += 3) {
      rgb[0] = bgr[2];
      rgb[1] = bgr[1];
      rgb[2] = bgr[0];
    }
  }
}

}  // namespace

std::vector<unsigned char> encodePng(const BgrPixels& picture) {
  const CodecPtr codec = openPngCodec(picture.width_px, picture.height_px);
  const PicturePtr rgb = makePicture(*codec);
  copyPixels(picture, *rgb);
  requireSuccess(avcodec_send_frame(codec.get(), rgb.get()));
  requireSuccess(avcodec_send_frame(codec.get(), nullptr));
  const PacketPtr packet(requireMemory(av_packet_alloc()));
  requireSuccess(avcodec_receive_packet(codec.get(), packet.get()));
  return {packet->data, packet->data + packet->size};
}

}  // namespace hapticast::media
