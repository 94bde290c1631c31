// SPDX-License-Identifier: MIT
#include "server/source/live/network_stream.hpp"

#include <utility>

#include "server/source/live/capture_clock.hpp"
#include "server/source/live/live_source.hpp"
#include "server/source/stream_url.hpp"
#include "server/source/video/video_clip.hpp"
#include "server/source/video/video_file.hpp"

namespace hapticast::server {

namespace {

using std::chrono::seconds;

// Chosen: shorter interruptions keep the connection. Many senders end with it, and a new connection
// waits for a key frame.
constexpr Duration kLongestSilence = seconds(4);
constexpr Duration kConnectTime = seconds(20);  // chosen: includes the wait for a key frame

/// An open stream.
class StreamDevice final : public LiveDevice {
 public:
  StreamDevice(const std::string& url, const VideoLayout& layout, double fps,
               const LiveWatch& watch)
      : shown_(hideCredentials(url)), watch_(watch), deadline_(clock_.now() + kConnectTime) {
    auto video = std::make_unique<VideoFile>(NetworkStream{
        findScheme(url) + url.substr(url.find("://")), shown_, [this] { return mustGiveUp(); }});
    video_ = std::make_unique<VideoClip>(std::move(video), layout, fps);
    info_ = video_->info();
    info_.name = streamName(url);
  }

  [[nodiscard]] const SourceInfo& info() const override { return info_; }

  std::optional<LiveFrame> read() override {
    if (!last_frame_) last_frame_ = clock_.now();
    deadline_ = *last_frame_ + kLongestSilence;
    std::optional<RgbdFrame> frame;
    try {
      frame = video_->read();
    } catch (const SourceError&) {  // as at the end: the next connection may be better
    }
    if (!frame) throw SourceError("no frames from " + shown_ + " since it ended");
    const LocalTime now = clock_.now();
    last_frame_ = now;
    const auto captured = capture_clock_.capture(frame->clip_time_s, now);
    if (!captured) return std::nullopt;
    return LiveFrame{std::move(frame->color), std::move(frame->depth), *captured};
  }

 private:
  /// Returns whether a wait for the network must end. Called by the libraries while they wait.
  bool mustGiveUp() {
    const LocalTime now = clock_.now();
    if (last_frame_ && now - *last_frame_ > kGap)
      watch_.begin_gap("no frames from " + shown_ +
                       " for 1 s; the server waits, and connects again after 4 s");
    return watch_.must_stop() || now > deadline_;
  }

  const std::string shown_;  // the address without secrets
  const LiveWatch& watch_;
  const SteadyClock clock_;
  LocalTime deadline_;                   // when a wait for the network ends
  std::optional<LocalTime> last_frame_;  // nullopt: the stream is not read yet
  CaptureClock capture_clock_;
  SourceInfo info_;
  std::unique_ptr<VideoClip> video_;  // last: it calls mustGiveUp()
};

}  // namespace

std::unique_ptr<RgbdSource> openNetworkStream(const std::string& url, const VideoLayout& layout,
                                              double fps) {
  return std::make_unique<LiveSource>([=](const LiveWatch& watch) {
    return std::make_unique<StreamDevice>(url, layout, fps, watch);
  });
}

}  // namespace hapticast::server
