// SPDX-License-Identifier: MIT
#include "server/source/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "server/source/picture/image_file.hpp"

namespace hapticast::server {

namespace {

constexpr Duration kReadWait = std::chrono::milliseconds(50);  // chosen: read() sees a stop so late
constexpr Duration kRetryPause = std::chrono::seconds(1);      // chosen

}  // namespace

LiveSource::LiveSource(Open open) : open_(std::move(open)) {
  watch_.must_stop = [token = stop_.get_token()] { return token.stop_requested(); };
  watch_.begin_gap = [this](const std::string& line) { beginGap(line); };
  device_ = open_(watch_);
  info_ = device_->info();
  info_.live = true;
  for (const std::string& warning : device_->warnings()) spdlog::warn("{}", warning);
  last_frame_ = clock_.now();
  thread_ = std::jthread([this] { run(stop_.get_token()); });
}

LiveSource::~LiveSource() { stop_.request_stop(); }

void LiveSource::run(const std::stop_token& stop) {
  try {
    do {
      play(stop);
      device_.reset();
    } while (reopen(stop));
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

void LiveSource::play(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) {
      if (auto frame = device_->read()) deliver(std::move(*frame));
    }
  } catch (const SourceError& error) {
    if (!stop.stop_requested())
      beginGap(std::string(error.what()) + "; the server tries to open it again each second");
  }
}

void LiveSource::deliver(LiveFrame live) {
  const LocalTime now = clock_.now();
  const Duration gap = now - std::exchange(last_frame_, now);
  const bool begins = next_ == 0 || in_gap_ || gap > kGap;
  if (std::exchange(in_gap_, false))
    spdlog::info("{}: frames are back after {:.1f} s", info_.name, toSeconds(gap));
  last_captured_ = std::max(last_captured_, live.captured);
  if (begins) epoch_begin_ = last_captured_;
  if (begins && next_ > 0) ++epoch_;
  RgbdFrame frame;
  frame.index = next_++;
  frame.epoch = epoch_;
  frame.clip_time_s = toSeconds(last_captured_ - epoch_begin_);
  frame.color = std::move(live.color);
  frame.depth = std::move(live.depth);
  {
    const std::lock_guard lock(mutex_);
    newest_ = Captured{std::move(frame), last_captured_};
  }
  changed_.notify_all();
}

bool LiveSource::reopen(const std::stop_token& stop) {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      (void)changed_.wait_for(lock, stop, kRetryPause, [] { return false; });
    }
    if (stop.stop_requested()) return false;
    try {
      device_ = open_(watch_);
    } catch (const SourceError&) {
      continue;  // the gap is in the log
    }
    const SourceInfo& now = device_->info();
    if (now.width_px == info_.width_px && now.height_px == info_.height_px &&
        now.depth_kind == info_.depth_kind)
      return true;
    fail(info_.name + ": came back with other pictures or depth (" +
         sizeText(now.width_px, now.height_px) + "), but began with " +
         sizeText(info_.width_px, info_.height_px) + "; start the server again");
    return false;
  }
}

void LiveSource::beginGap(const std::string& line) {
  if (!std::exchange(in_gap_, true)) spdlog::warn("{}", line);
}

void LiveSource::fail(const std::string& problem) {
  {
    const std::lock_guard lock(mutex_);
    failure_ = problem;
  }
  changed_.notify_all();
}

std::optional<RgbdFrame> LiveSource::read() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kReadWait, [this] { return newest_ || !failure_.empty(); });
  if (!failure_.empty()) throw SourceError(failure_);
  if (!newest_) return std::nullopt;
  Captured newest = std::move(*newest_);
  newest_.reset();
  newest.frame.age = std::max(clock_.now() - newest.at, Duration{});
  if (newest.frame.age > kGap) return std::nullopt;  // it waited since before a gap
  return std::move(newest.frame);
}

bool LiveSource::skip() {
  (void)read();
  return true;
}

void LiveSource::rewind() { throw SourceError(info_.name + ": is live and cannot be rewound"); }

}  // namespace hapticast::server
