// SPDX-License-Identifier: MIT
// Films: H.264 or MPEG-4 part 2 with 4:2:0 chroma, in MP4 files.
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/media/module/encoders.hpp"
#include "common/media/module/libav.hpp"

namespace hapticast::media {

namespace {

constexpr int kMostRate = 65535;    // numerator and denominator of a rate: the limit of MPEG-4
constexpr int kMpeg4Quantizer = 3;  // chosen: no visible loss

/// Opens an encoder of `id`. Returns null if there is none for this format.
CodecPtr openFilmCodec(AVCodecID id, const FilmFormat& format) {
  const AVCodec* const kind = avcodec_find_encoder(id);
  if (kind == nullptr) return nullptr;
  CodecPtr codec(requireMemory(avcodec_alloc_context3(kind)));
  codec->width = format.width_px;
  codec->height = format.height_px;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->color_range = AVCOL_RANGE_MPEG;  // this line and the next one: what the scaler makes
  codec->colorspace = AVCOL_SPC_SMPTE170M;
  codec->framerate = av_d2q(format.fps, kMostRate);
  codec->time_base = av_inv_q(codec->framerate);
  codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;  // MP4 has the header of the codec once
  if (id == AV_CODEC_ID_MPEG4) {
    codec->flags |= AV_CODEC_FLAG_QSCALE;
    codec->global_quality = kMpeg4Quantizer * FF_QP2LAMBDA;
  }
  if (avcodec_open2(codec.get(), kind, nullptr) < 0) return nullptr;
  return codec;
}

class Film final : public FilmEncoder {
 public:
  explicit Film(std::string file) : file_(std::move(file)) {}
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  ~Film() override { discard(); }

  /// Opens encoder and file. Throws like MediaModule::openFilm().
  void open(const FilmFormat& format);
  void write(const BgrPixels& picture) override;
  void close() override;

 private:
  void openFile();
  /// Encodes `picture`, or what is left if it is null, and writes the packets that are ready.
  void encode(const AVFrame* picture);
  /// Throws for an incomplete file if `result` is an error.
  void require(int result);
  /// Closes the file. Removes it if it was opened and is not complete.
  void discard();

  std::string file_;
  CodecPtr codec_;
  ScalerPtr scaler_;
  PicturePtr picture_;
  PacketPtr packet_;
  MuxerPtr muxer_;  // null: not open
};

void Film::open(const FilmFormat& format) {
  for (const AVCodecID id : {AV_CODEC_ID_H264, AV_CODEC_ID_MPEG4}) {
    codec_ = openFilmCodec(id, format);
    if (codec_) break;
  }
  if (!codec_)
    throw std::runtime_error(file_ + ": FFmpeg has no encoder for it; install one for H.264");
  picture_ = makePicture(*codec_);
  picture_->pts = 0;
  packet_.reset(requireMemory(av_packet_alloc()));
  scaler_.reset(requireMemory(sws_getContext(format.width_px, format.height_px, AV_PIX_FMT_BGR24,
                                             format.width_px, format.height_px, codec_->pix_fmt,
                                             SWS_BICUBIC, nullptr, nullptr, nullptr)));
  openFile();
}

void Film::openFile() {
  AVFormatContext* muxer = nullptr;
  if (avformat_alloc_output_context2(&muxer, nullptr, "mp4", nullptr) < 0)
    throw std::runtime_error(file_ + ": FFmpeg cannot write MP4 files; install a complete FFmpeg");
  MuxerPtr opened(muxer);
  AVStream* const stream = requireMemory(avformat_new_stream(muxer, nullptr));
  if (avcodec_parameters_from_context(stream->codecpar, codec_.get()) < 0) throw std::bad_alloc();
  stream->time_base = codec_->time_base;
  stream->avg_frame_rate = codec_->framerate;
  // "file:": the name is no address of another protocol.
  const int result = avio_open(&muxer->pb, ("file:" + file_).c_str(), AVIO_FLAG_WRITE);
  if (result < 0)
    throw std::runtime_error(file_ + ": cannot be written (" + describe(result) + ")");
  muxer_ = std::move(opened);
  require(avformat_write_header(muxer, nullptr));
}

void Film::write(const BgrPixels& picture) {
  require(av_frame_make_writable(picture_.get()));
  const int stride = static_cast<int>(picture.stride_bytes);
  require(sws_scale(scaler_.get(), &picture.data, &stride, 0, picture.height_px, picture_->data,
                    picture_->linesize));
  encode(picture_.get());
  ++picture_->pts;
}

void Film::encode(const AVFrame* picture) {
  require(avcodec_send_frame(codec_.get(), picture));
  while (true) {
    const int result = avcodec_receive_packet(codec_.get(), packet_.get());
    if (result == AVERROR(EAGAIN) || result == AVERROR_EOF) return;
    require(result);
    packet_->duration = 1;
    av_packet_rescale_ts(packet_.get(), codec_->time_base, muxer_->streams[0]->time_base);
    require(av_interleaved_write_frame(muxer_.get(), packet_.get()));
  }
}

void Film::close() {
  encode(nullptr);
  require(av_write_trailer(muxer_.get()));
  require(avio_closep(&muxer_->pb));
  muxer_.reset();
}

void Film::require(int result) {
  if (result >= 0) return;
  discard();
  const bool is_full = result == AVERROR(ENOSPC) || result == AVERROR(EDQUOT);
  throw std::runtime_error(file_ + ": not written completely" +
                           (is_full ? "; is the disk full?" : " (" + describe(result) + ")"));
}

void Film::discard() {
  if (!muxer_) return;
  muxer_.reset();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file_, ignored)) std::filesystem::remove(file_, ignored);
}

}  // namespace

std::unique_ptr<FilmEncoder> openFilm(const std::string& file, const FilmFormat& format) {
  auto film = std::make_unique<Film>(file);
  film->open(format);
  return film;
}

}  // namespace hapticast::media
