// SPDX-License-Identifier: MIT
#include "server/source/live/live_video.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "server/source/picture/image_file.hpp"
#include "server/source/stream_url.hpp"
#include "server/source/video/video_file.hpp"

namespace hapticast::server {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Duration kReadWait = milliseconds(50);  // chosen: how soon a server notices its stop
constexpr Duration kSilence = seconds(1);         // of a stream: a gap
// Chosen: shorter interruptions keep the connection. Many senders end with it, and a new connection
// waits for a key frame.
constexpr Duration kLongestSilence = seconds(4);
constexpr Duration kConnectTime = seconds(20);  // chosen: includes the wait for a key frame
constexpr Duration kFirstPause = milliseconds(500);
constexpr Duration kLongestPause = seconds(5);

}  // namespace

LiveVideo::LiveVideo(std::string url, const VideoLayout& layout, double fps)
    : url_(std::move(url)), shown_(hideCredentials(url_)), layout_(layout), fps_(fps) {
  connect();
  info_ = video_->info();
  info_.name = streamName(url_);
  last_frame_ = clock_.now();
  thread_ = std::jthread([this] { run(); });
}

LiveVideo::~LiveVideo() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
}

void LiveVideo::connect() {
  deadline_ = clock_.now() + kConnectTime;
  auto video = std::make_unique<VideoFile>(NetworkStream{
      findScheme(url_) + url_.substr(url_.find("://")), shown_, [this] { return mustGiveUp(); }});
  video_ = std::make_unique<VideoClip>(std::move(video), layout_, fps_);
}

bool LiveVideo::mustGiveUp() {
  const LocalTime now = clock_.now();
  if (playing_ && now - last_frame_ > kSilence)
    beginGap("for 1 s; the server waits, and reconnects after 4 s");
  return stop_ || now > deadline_;
}

void LiveVideo::beginGap(const char* cause) {
  if (std::exchange(in_gap_, true) || stop_) return;
  spdlog::warn("no frames from {} {}", shown_, cause);
}

void LiveVideo::run() {
  try {
    do {
      play();
      video_.reset();
    } while (reconnect());
  } catch (const std::exception& error) {
    fail(error.what());
  }
  video_.reset();
}

void LiveVideo::play() {
  playing_ = true;
  deadline_ = clock_.now() + kLongestSilence;
  while (!stop_) {
    std::optional<RgbdFrame> frame = readFrame();
    if (!frame) break;
    const LocalTime now = clock_.now();
    deadline_ = now + kLongestSilence;
    if (const auto captured = capture_clock_.capture(frame->clip_time_s, now))
      deliver(std::move(*frame), *captured);
  }
  playing_ = false;
}

std::optional<RgbdFrame> LiveVideo::readFrame() {
  try {
    return video_->read();
  } catch (const SourceError&) {
    return std::nullopt;  // as at the end: the next connection may be better
  }
}

void LiveVideo::deliver(RgbdFrame frame, LocalTime captured) {
  const LocalTime now = clock_.now();
  const Duration gap = now - std::exchange(last_frame_, now);
  const bool begins = next_ == 0 || in_gap_ || gap > kSilence;
  if (std::exchange(in_gap_, false))
    spdlog::info("frames from {} are back after {:.1f} s", shown_, toSeconds(gap));
  if (begins) epoch_begin_ = captured;
  if (begins && next_ > 0) ++epoch_;
  frame.index = next_++;
  frame.epoch = epoch_;
  frame.clip_time_s = toSeconds(captured - epoch_begin_);
  {
    const std::lock_guard lock(mutex_);
    newest_ = Captured{std::move(frame), captured};
  }
  changed_.notify_all();
}

bool LiveVideo::reconnect() {
  beginGap("since it ended; the server reconnects");
  for (Duration pause = kFirstPause; wait(pause); pause = std::min(2 * pause, kLongestPause)) {
    try {
      connect();
    } catch (const SourceError&) {
      continue;  // the gap is in the log
    }
    const SourceInfo& now = video_->info();
    if (now.width_px != info_.width_px || now.height_px != info_.height_px ||
        now.depth_kind != info_.depth_kind) {
      fail(shown_ + ": came back with other pictures or depth (" +
           sizeText(now.width_px, now.height_px) + "), but began with " +
           sizeText(info_.width_px, info_.height_px) + "; start the server again");
      return false;
    }
    capture_clock_ = {};
    return true;
  }
  return false;
}

bool LiveVideo::wait(Duration pause) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_for(lock, pause, [this] { return stop_.load(); });
}

void LiveVideo::fail(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    failure_ = problem;
  }
  changed_.notify_all();
}

std::optional<RgbdFrame> LiveVideo::read() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kReadWait, [this] { return newest_ || !failure_.empty(); });
  if (!failure_.empty()) throw SourceError(failure_);
  if (!newest_) return std::nullopt;
  Captured newest = std::move(*newest_);
  newest_.reset();
  newest.frame.age = clock_.now() - newest.at;
  // It waited since before a gap.
  if (newest.frame.age > kSilence) return std::nullopt;
  return std::move(newest.frame);
}

bool LiveVideo::skip() {
  (void)read();
  return true;
}

void LiveVideo::rewind() { throw SourceError(shown_ + ": is live and cannot be rewound"); }

}  // namespace hapticast::server
