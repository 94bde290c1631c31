// SPDX-License-Identifier: MIT
#include "server/source/video/video_format.hpp"

#include <array>
#include <cstddef>
#include <string_view>

#include "server/source/stream_url.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kMostProbed = 64;  // streams of a file that is refused for their number
constexpr std::int64_t kProbe_bytes = 5'000'000;
constexpr std::int64_t kProbe_us = 5'000'000;
// Streams that were joined in the middle: key frames are often 10 s apart.
constexpr std::int64_t kStreamProbe_bytes = 20'000'000;
constexpr std::int64_t kStreamProbe_us = 11'000'000;
constexpr std::int64_t kNetworkTimeout_us = 5'000'000;  // chosen
/// Formats that one stream over a network may have. Playlists and descriptions of other streams are
/// none of them.
constexpr const char* kStreamFormats =
    "rtsp,rtp,mpegts,matroska,mov,flv,nut,avi,ogg,mpjpeg,h264,hevc";

/// Options for libav, which are freed.
class LibavOptions {
 public:
  LibavOptions() = default;
  ~LibavOptions() { av_dict_free(&options_); }
  LibavOptions(const LibavOptions&) = delete;
  LibavOptions& operator=(const LibavOptions&) = delete;
  void set(const char* name, std::int64_t value) { av_dict_set_int(&options_, name, value, 0); }
  void set(const char* name, const char* value) { av_dict_set(&options_, name, value, 0); }
  AVDictionary** get() { return &options_; }

 private:
  AVDictionary* options_ = nullptr;
};

/// Reads the begin of each stream of `format`. Throws SourceError.
void findStreams(AVFormatContext& format, const std::string& name, bool live) {
  if (format.nb_streams > kMostStreams) {
    throw SourceError(name + ": has " + std::to_string(format.nb_streams) +
                      " tracks; allowed are 16, so copy the video out (ffmpeg -i FILE -map 0:v "
                      "-c copy OUT.mkv)");
  }
  // A later stream of the file would have no options of its own.
  std::array<LibavOptions, kMostStreams> limits;
  std::array<AVDictionary*, kMostProbed> each{};
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    limits[i].set("max_pixels", kMostDecoded_px);
    av_dict_copy(&each[i], *limits[i].get(), 0);
  }
  const int found = avformat_find_stream_info(&format, each.data());
  for (AVDictionary*& options_of_stream : each) av_dict_free(&options_of_stream);
  if (found < 0 || format.nb_streams > kMostStreams) throwNoVideo(name, live);
}

/// Returns the protocols that an address of this scheme may use, also where it is redirected.
const char* protocolsOf(std::string_view scheme) {
  if (scheme.starts_with("http")) return "http,https,httpproxy,tcp,tls,crypto";
  if (scheme.starts_with("rtsp")) return "rtsp,rtsps,rtp,udp,tcp,tls";
  if (scheme == "srt") return "srt";
  if (scheme == "tcp") return "tcp";
  return "rtp,udp";
}

int callGiveUp(void* give_up) { return (*static_cast<const std::function<bool()>*>(give_up))(); }

void setStreamOptions(LibavOptions& options, std::string_view scheme) {
  options.set("probesize", kStreamProbe_bytes);
  options.set("analyzeduration", kStreamProbe_us);
  options.set("max_streams", std::int64_t{kMostProbed});
  options.set("protocol_whitelist", protocolsOf(scheme));
  options.set("format_whitelist", kStreamFormats);
  options.set("timeout", kNetworkTimeout_us);
  options.set("connect_timeout", kNetworkTimeout_us / 1000);  // SRT: ms
  options.set("tls_verify", std::int64_t{1});
  // A lost packet would damage depth.
  options.set("rtsp_flags", "prefer_tcp");
  options.set("overrun_nonfatal", std::int64_t{1});  // UDP
}

[[noreturn]] void throwCannotOpen(const std::string& name, int error) {
  if (error == AVERROR_INVALIDDATA) throwNoVideo(name, true);
  if (error == AVERROR(EINVAL)) {
    throw SourceError(name +
                      ": is no single stream, but a playlist, a page, or a way to another place; "
                      "name the address of the stream itself");
  }
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  // SRT reports nothing else, and HTTP reports it for a page without a length.
  const std::string what = error == AVERROR_EXIT   ? "no answer in time"
                           : error == AVERROR(EIO) ? "no answer, or no video"
                                                   : text.data();
  throw SourceError(name + ": cannot be opened (" + what +
                    "); start the sender first, and check address, password and firewall");
}

}  // namespace

void throwNoVideo(const std::string& name, bool live) {
  throw NoVideoError(name + (live ? ": delivers no video that can be read; send, for example, "
                                    "H.264 in MPEG-TS"
                                  : ": holds no video that can be read; convert it, for example to "
                                    "H.264 in MP4"));
}

FormatPtr openFormat(const std::string& file) {
  av_log_set_level(AV_LOG_QUIET);  // FFmpeg's own log would hide the error message
  LibavOptions options;
  options.set("probesize", kProbe_bytes);
  options.set("analyzeduration", kProbe_us);
  options.set("max_streams", std::int64_t{kMostProbed});
  options.set("protocol_whitelist", "file");
  AVFormatContext* raw = nullptr;
  if (avformat_open_input(&raw, ("file:" + file).c_str(), nullptr, options.get()) < 0)
    throwNoVideo(file, false);
  FormatPtr format(raw);
  for (const std::string_view playlist : {"hls", "dash", "concat", "sdp", "imf"}) {
    if (format->iformat->name == playlist)
      throw SourceError(file + ": is a playlist; name the video file itself");
  }
  findStreams(*format, file, false);
  return format;
}

FormatPtr openFormat(const NetworkStream& stream) {
  av_log_set_level(AV_LOG_QUIET);  // its log would show passwords, too
  LibavOptions options;
  setStreamOptions(options, findScheme(stream.url));
  AVFormatContext* raw = avformat_alloc_context();
  if (raw == nullptr) throwNoVideo(stream.name, true);
  raw->interrupt_callback = {callGiveUp, const_cast<std::function<bool()>*>(&stream.give_up)};
  const int opened = avformat_open_input(&raw, stream.url.c_str(), nullptr, options.get());
  if (opened < 0) throwCannotOpen(stream.name, opened);
  FormatPtr format(raw);
  if (format->pb != nullptr && avio_size(format->pb) > 0) {
    throw SourceError(stream.name +
                      ": is a recorded file, not a live stream; download it, then use the file");
  }
  findStreams(*format, stream.name, true);
  return format;
}

}  // namespace hapticast::server
