// SPDX-License-Identifier: MIT
#include "server/source/video/video_file.hpp"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/display.h>
#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <deque>
#include <filesystem>
#include <limits>
#include <string_view>
#include <utility>

#include "server/source/picture/image_file.hpp"
#include "server/source/video/display_matrix.hpp"
#include "server/source/video/video_format.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostWaiting_bytes = 256U << 20U;  // chosen: a second of raw pictures
constexpr std::size_t kMostWaiting_packets = 2000;
constexpr std::size_t kMostTimes = 4'000'000;  // 18 hours of 60 frames/s
constexpr int kMostTries = 4096;               // packets without a picture, as OpenCV allows

struct ScalerDelete {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};
using CodecPtr = std::unique_ptr<AVCodecContext, LibavDelete<AVCodecContext, avcodec_free_context>>;
using PacketPtr = std::unique_ptr<AVPacket, LibavDelete<AVPacket, av_packet_free>>;
using PicturePtr = std::unique_ptr<AVFrame, LibavDelete<AVFrame, av_frame_free>>;
using ScalerPtr = std::unique_ptr<SwsContext, ScalerDelete>;

/// Returns a text of the file in small letters; "" if it has none.
std::string lowerTag(const AVDictionary* tags, const char* name) {
  const AVDictionaryEntry* const entry = av_dict_get(tags, name, nullptr, 0);
  std::string text = entry == nullptr ? "" : entry->value;
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Returns by how many degrees the picture turns clockwise to be shown: 0, 90, 180 or 270.
int findTurn(const AVStream& stream) {
  const std::int32_t* const matrix = findDisplayMatrix(stream);
  if (matrix == nullptr) return 0;
  const double angle_deg = av_display_rotation_get(matrix);
  if (!std::isfinite(angle_deg)) return 0;
  const int turn_deg = static_cast<int>(std::lround(-angle_deg) + 720) % 360;
  return turn_deg % 90 == 0 ? turn_deg : 0;
}

double statedRate(AVFormatContext* format, AVStream* stream) {
  double fps = av_q2d(av_guess_frame_rate(format, stream, nullptr));
  if (!(fps > 0.0)) fps = av_q2d(stream->avg_frame_rate);
  return fps > 0.0 && std::isfinite(fps) ? fps : 0.0;
}

std::uint64_t estimateFrameCount(const AVFormatContext& format, const AVStream& stream,
                                 double fps) {
  if (stream.nb_frames > 0) return static_cast<std::uint64_t>(stream.nb_frames);
  double duration_s = static_cast<double>(format.duration) / AV_TIME_BASE;
  if (format.duration <= 0)
    duration_s = static_cast<double>(stream.duration) * av_q2d(stream.time_base);
  const double count = std::floor(duration_s * fps + 0.5);
  return count >= 1.0 && count < 1e9 ? static_cast<std::uint64_t>(count) : 0;
}

/// Sets what `track` says about its pixel format.
void describeFormat(int format, VideoTrack& track) {
  const AVPixFmtDescriptor* const about = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(format));
  if (about == nullptr) return;
  constexpr std::uint64_t kOtherKinds = AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_FLOAT |
                                        AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL;
  track.format = about->name;
  track.bits = about->comp[0].depth;
  track.grey = about->nb_components == 1 && (about->flags & kOtherKinds) == 0;
}

VideoTrack describeTrack(AVFormatContext* format, AVStream* stream) {
  VideoTrack track;
  track.width_px = stream->codecpar->width;
  track.height_px = stream->codecpar->height;
  if (findTurn(*stream) % 180 != 0) std::swap(track.width_px, track.height_px);
  track.fps = statedRate(format, stream);
  track.frame_count = estimateFrameCount(*format, *stream, track.fps);
  describeFormat(stream->codecpar->format, track);
  for (const char* name : {"title", "handler_name", "name"})
    track.depth_name |= lowerTag(stream->metadata, name).find("depth") != std::string::npos;
  track.kinect_depth = av_dict_get(stream->metadata, "K4A_DEPTH_TRACK", nullptr, 0) != nullptr;
  return track;
}

/// Returns the values of a grey picture of more than 8 bits, in the machine's byte order.
cv::Mat copyGrey(const AVFrame& picture, bool big_endian) {
  cv::Mat values(picture.height, picture.width, CV_16UC1);
  for (int v = 0; v < picture.height; ++v) {
    const std::uint8_t* from = picture.data[0] + std::ptrdiff_t{v} * picture.linesize[0];
    auto* const to = values.ptr<std::uint16_t>(v);
    for (int u = 0; u < picture.width; ++u, from += 2) {
      to[u] = static_cast<std::uint16_t>(big_endian ? from[0] << 8U | from[1]
                                                    : from[1] << 8U | from[0]);
    }
  }
  return values;
}

cv::Mat turn(const cv::Mat& picture, int clockwise_deg) {
  if (clockwise_deg == 0) return picture;
  cv::Mat turned;
  cv::rotate(picture, turned,
             clockwise_deg == 90    ? cv::ROTATE_90_CLOCKWISE
             : clockwise_deg == 180 ? cv::ROTATE_180
                                    : cv::ROTATE_90_COUNTERCLOCKWISE);
  return turned;
}

/// One track that is decoded, or may be.
struct TrackDecoder {
  AVStream* stream = nullptr;
  int turn_deg = 0;
  CodecPtr codec;  // null: not started
  ScalerPtr scaler;
  PicturePtr picture;
  cv::Mat padded;       // buffer of convertToBgr()
  bool usable = false;  // whether `picture` is whole
  std::deque<PacketPtr> waiting;
  std::size_t waiting_bytes = 0;
};

}  // namespace

struct VideoFile::Parts {
  std::string file;
  NetworkStream stream;  // outlives the format; empty for a file
  FormatPtr format;
  std::vector<VideoTrack> tracks;
  std::vector<TrackDecoder> decoders;

  [[nodiscard]] bool isLive() const { return !stream.url.empty(); }
  /// Fills in `tracks` and `decoders`. Throws NoVideoError if there are none.
  void findTracks();
  /// Puts the next packet of a started track into that track's queue. Returns false at the end.
  bool readPacket();
  /// Returns the next packet of `decoder`; null at the end.
  PacketPtr nextPacket(TrackDecoder& decoder);
  cv::Mat convertToBgr(TrackDecoder& decoder) const;
};

bool VideoFile::Parts::readPacket() {
  PacketPtr packet(av_packet_alloc());
  if (av_read_frame(format.get(), packet.get()) < 0) return false;
  for (TrackDecoder& decoder : decoders) {
    if (decoder.codec == nullptr || decoder.stream->index != packet->stream_index) continue;
    decoder.waiting_bytes += static_cast<std::size_t>(std::max(packet->size, 0));
    decoder.waiting.push_back(std::move(packet));
    if (decoder.waiting_bytes > kMostWaiting_bytes ||
        decoder.waiting.size() > kMostWaiting_packets) {
      throw SourceError(
          file +
          ": its tracks do not lie side by side; write it anew (ffmpeg -i FILE -map 0 "
          "-c copy OUT.mkv)");
    }
    break;
  }
  return true;
}

PacketPtr VideoFile::Parts::nextPacket(TrackDecoder& decoder) {
  while (decoder.waiting.empty()) {
    if (!readPacket()) return nullptr;
  }
  PacketPtr packet = std::move(decoder.waiting.front());
  decoder.waiting.pop_front();
  decoder.waiting_bytes -= static_cast<std::size_t>(std::max(packet->size, 0));
  return packet;
}

cv::Mat VideoFile::Parts::convertToBgr(TrackDecoder& decoder) const {
  const AVFrame& picture = *decoder.picture;
  const auto format_of = static_cast<AVPixelFormat>(picture.format);
  // Bicubic without further settings, as OpenCV converts videos.
  decoder.scaler.reset(sws_getCachedContext(
      decoder.scaler.release(), picture.width, picture.height, format_of, picture.width,
      picture.height, AV_PIX_FMT_BGR24, SWS_BICUBIC, nullptr, nullptr, nullptr));
  if (decoder.scaler == nullptr) return {};
  // The scaler writes whole vectors, beyond the end of a line.
  constexpr int kVector_px = 64;
  const int padded_px = (picture.width + kVector_px - 1) / kVector_px * kVector_px;
  const bool fits = padded_px == picture.width;
  cv::Mat exact;
  cv::Mat& target = fits ? exact : decoder.padded;
  target.create(picture.height, padded_px, CV_8UC3);
  const std::array<std::uint8_t*, 4> to{target.data};
  const std::array<int, 4> step{static_cast<int>(target.step)};
  if (sws_scale(decoder.scaler.get(), picture.data, picture.linesize, 0, picture.height, to.data(),
                step.data()) != picture.height)
    return {};
  if (fits) return exact;
  return target(cv::Rect(0, 0, picture.width, picture.height)).clone();
}

VideoFile::VideoFile(std::string file) : parts_(std::make_unique<Parts>()) {
  parts_->file = std::move(file);
  std::error_code error;
  if (!std::filesystem::is_regular_file(parts_->file, error))
    throw SourceError(parts_->file + ": no such file");
  parts_->format = openFormat(parts_->file);
  parts_->findTracks();
}

VideoFile::VideoFile(NetworkStream stream) : parts_(std::make_unique<Parts>()) {
  parts_->file = stream.name;
  parts_->stream = std::move(stream);
  parts_->format = openFormat(parts_->stream);
  parts_->findTracks();
}

void VideoFile::Parts::findTracks() {
  for (unsigned i = 0; i < format->nb_streams; ++i) {
    AVStream* const stream_i = format->streams[i];
    const bool is_video = stream_i->codecpar->codec_type == AVMEDIA_TYPE_VIDEO &&
                          (stream_i->disposition & AV_DISPOSITION_ATTACHED_PIC) == 0;
    if (!is_video || avcodec_find_decoder(stream_i->codecpar->codec_id) == nullptr) continue;
    tracks.push_back(describeTrack(format.get(), stream_i));
    TrackDecoder decoder;
    decoder.stream = stream_i;
    decoder.turn_deg = findTurn(*stream_i);
    decoders.push_back(std::move(decoder));
  }
  if (tracks.empty()) throwNoVideo(file, isLive());
}

VideoFile::~VideoFile() = default;

const std::string& VideoFile::file() const { return parts_->file; }

bool VideoFile::isLive() const { return parts_->isLive(); }

const std::vector<VideoTrack>& VideoFile::tracks() const { return parts_->tracks; }

std::string VideoFile::attachment(const std::string& name) const {
  for (unsigned i = 0; i < parts_->format->nb_streams; ++i) {
    const AVStream& stream = *parts_->format->streams[i];
    const AVCodecParameters& about = *stream.codecpar;
    if (about.codec_type != AVMEDIA_TYPE_ATTACHMENT || about.extradata == nullptr) continue;
    if (lowerTag(stream.metadata, "filename") != name) continue;
    return {reinterpret_cast<const char*>(about.extradata),
            static_cast<std::size_t>(std::max(about.extradata_size, 0))};
  }
  return "";
}

std::vector<double> VideoFile::readTimes(std::size_t track) {
  const AVStream& stream = *parts_->decoders.at(track).stream;
  for (unsigned i = 0; i < parts_->format->nb_streams; ++i) {
    AVStream& other = *parts_->format->streams[i];
    if (other.index != stream.index) other.discard = AVDISCARD_ALL;
  }
  std::vector<double> times_s;
  for (;;) {
    const PacketPtr packet(av_packet_alloc());
    if (packet == nullptr || av_read_frame(parts_->format.get(), packet.get()) < 0) break;
    if (packet->stream_index != stream.index || (packet->flags & AV_PKT_FLAG_DISCARD) != 0)
      continue;
    if (packet->pts == AV_NOPTS_VALUE || times_s.size() == kMostTimes) return {};
    times_s.push_back(static_cast<double>(packet->pts) * av_q2d(stream.time_base));
  }
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

void VideoFile::start(std::size_t track) {
  TrackDecoder& decoder = parts_->decoders.at(track);
  const AVCodec* const kind = avcodec_find_decoder(decoder.stream->codecpar->codec_id);
  CodecPtr codec(avcodec_alloc_context3(kind));
  decoder.picture.reset(av_frame_alloc());
  if (codec == nullptr || decoder.picture == nullptr ||
      avcodec_parameters_to_context(codec.get(), decoder.stream->codecpar) < 0)
    throwNoVideo(parts_->file, parts_->isLive());
  codec->thread_count = 1;
  codec->pkt_timebase = decoder.stream->time_base;
  codec->max_pixels = kMostDecoded_px;
  // PNG has check sums: no damaged depth is replaced by a guess. FFV1's decoder ignores this.
  if (codec->codec_id == AV_CODEC_ID_PNG) codec->err_recognition = AV_EF_CRCCHECK | AV_EF_EXPLODE;
  if (avcodec_open2(codec.get(), kind, nullptr) < 0) throwNoVideo(parts_->file, parts_->isLive());
  decoder.codec = std::move(codec);
}

bool VideoFile::grab(std::size_t track) {
  TrackDecoder& decoder = parts_->decoders.at(track);
  decoder.usable = false;
  for (int tries = 0; tries < kMostTries; ++tries) {
    const int got = avcodec_receive_frame(decoder.codec.get(), decoder.picture.get());
    if (got == AVERROR_EOF) return false;
    if (got == 0) {
      const AVFrame& picture = *decoder.picture;
      decoder.usable =
          picture.decode_error_flags == 0 && (picture.flags & AV_FRAME_FLAG_CORRUPT) == 0;
      describeFormat(picture.format, parts_->tracks[track]);
      return true;
    }
    if (got != AVERROR(EAGAIN)) return true;  // a damaged frame
    const PacketPtr packet = parts_->nextPacket(decoder);
    const int sent = avcodec_send_packet(decoder.codec.get(), packet.get());
    if (sent < 0 && packet == nullptr) return false;
    if (sent < 0 && sent != AVERROR(EAGAIN)) return true;  // a damaged frame
  }
  return false;
}

double VideoFile::time_s(std::size_t track) const {
  const TrackDecoder& decoder = parts_->decoders.at(track);
  const std::int64_t time = decoder.picture->best_effort_timestamp;
  if (!decoder.usable || time == AV_NOPTS_VALUE) return -std::numeric_limits<double>::infinity();
  return static_cast<double>(time) * av_q2d(decoder.stream->time_base);
}

cv::Mat VideoFile::retrieveColor(std::size_t track) {
  TrackDecoder& decoder = parts_->decoders.at(track);
  if (!decoder.usable) return {};
  return turn(parts_->convertToBgr(decoder), decoder.turn_deg);
}

cv::Mat VideoFile::retrieveDepth(std::size_t track) {
  TrackDecoder& decoder = parts_->decoders.at(track);
  const VideoTrack& about = parts_->tracks[track];
  if (!about.grey || about.bits <= 8) return retrieveColor(track);
  if (!decoder.usable) return {};
  const AVPixFmtDescriptor* const format =
      av_pix_fmt_desc_get(static_cast<AVPixelFormat>(decoder.picture->format));
  const bool big_endian = (format->flags & AV_PIX_FMT_FLAG_BE) != 0;
  return turn(copyGrey(*decoder.picture, big_endian), decoder.turn_deg);
}

}  // namespace hapticast::server
