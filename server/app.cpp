// SPDX-License-Identifier: MIT
#include "server/app.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <thread>
#include <utility>

#include "server/source/playback.hpp"
#include "server/vision/picture.hpp"

namespace hapticast::server {

namespace {

constexpr int kJpegQuality = 80;
constexpr std::size_t kMostOutgoing = 2;  // frames between vision and bytes; then vision waits
// How long viewers get to play out the end of a clip before the server says goodbye.
constexpr Duration kPlayout = std::chrono::milliseconds(500);

std::string listenAddress(const Endpoint& endpoint) {
  const bool v6 = endpoint.host.find(':') != std::string::npos;
  return (v6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

}  // namespace

App::App(Settings settings, const Clock& clock)
    : settings_(std::move(settings)),
      media_clock_{clock, clock.now()},
      source_(openSource(settings_.source, settings_.fps)),
      vision_(source_->info(), settings_.vision, &clock),
      broadcaster_(io_, media_clock_, vision_.description(),
                   StreamSettings{.max_clients = settings_.max_clients}),
      listener_(io_, listenAddress(settings_.listen), broadcaster_) {}

void App::run() {
  asio::signal_set signals(io_, SIGINT, SIGTERM);
  signals.async_wait([this](const boost::system::error_code& error, int) {
    if (!error) stop();
  });
  std::jthread network([this] { io_.run(); });
  // The next frame is looked at while the last one becomes bytes and a JPEG.
  std::jthread encoder([this] { encodeAll(); });
  const auto end = [&] {
    {
      const std::lock_guard lock(outgoing_mutex_);
      ended_ = true;
    }
    outgoing_changed_.notify_all();
    encoder.join();
    listener_.stop();
    broadcaster_.stop();
    asio::post(io_, [&signals] { signals.cancel(); });
  };
  try {
    scan();
    if (!stop_) play();
  } catch (...) {
    end();
    throw;
  }
  end();
  if (failure_) std::rethrow_exception(failure_);  // of a frame after the last one published
}

void App::scan() {
  MediaTime told = media_clock_.now();
  const auto progress = [&](std::uint64_t done, std::uint64_t total) {
    if (stop_ || media_clock_.now() - told < std::chrono::seconds(1)) return !stop_;
    told = media_clock_.now();
    spdlog::info("looking through the clip for its depth range and motion: {} of {} frames", done,
                 total);
    return true;
  };
  if (!vision_.scan(*source_, progress)) return;
  announced_ = vision_.description();
  broadcaster_.describe(announced_);
}

void App::play() {
  const SourceInfo& info = source_->info();
  spdlog::info("listening on {}; streaming {} ({} x {}, {:g} frames/s). Ctrl-C ends it.",
               listenAddress({settings_.listen.host, port()}), info.name, info.width_px,
               info.height_px, info.fps);
  Pacer pacer(info.fps, media_clock_.now());
  std::uint64_t frames = 0;
  while (!stop_ && (settings_.frames == 0 || frames < settings_.frames)) {
    const auto frame = nextFrame(pacer);
    if (!frame) break;
    const MediaTime media_time =
        info.live ? media_clock_.now() : pacer.frameRead(frame->epoch, frame->index);
    ++frames;
    if (auto result = vision_.push(*frame, media_time)) publish(std::move(*result));
    if (settings_.explain) explain();
    sayWhatWasSkipped(pacer);
  }
  for (VisionResult& result : vision_.flush()) publish(std::move(result));
  waitUntil(last_published_ + vision_.description().pipeline_latency + kPlayout);
}

std::optional<RgbdFrame> App::nextFrame(Pacer& pacer) {
  if (source_->info().live) return source_->read();
  const Pacer::Plan plan = pacer.plan(media_clock_.now());
  waitUntil(plan.due);
  return readOn(*source_, plan.skip, settings_.loop && !stop_);
}

void App::publish(VisionResult result) {
  last_published_ = result.frame.media_time;
  std::unique_lock lock(outgoing_mutex_);
  outgoing_changed_.wait(lock, [&] { return outgoing_.size() < kMostOutgoing || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  outgoing_.push_back({vision_.description(), std::move(result)});
  outgoing_changed_.notify_all();
}

void App::encodeAll() {
  while (true) {
    std::unique_lock lock(outgoing_mutex_);
    outgoing_changed_.wait(lock, [&] { return !outgoing_.empty() || ended_; });
    if (outgoing_.empty()) return;
    const Outgoing next = std::move(outgoing_.front());
    outgoing_.pop_front();
    outgoing_changed_.notify_all();
    lock.unlock();
    try {
      encode(next);
    } catch (...) {
      lock.lock();
      failure_ = std::current_exception();
      outgoing_changed_.notify_all();
      return;
    }
  }
}

void App::encode(const Outgoing& next) {
  if (next.description != announced_) {
    announced_ = next.description;
    broadcaster_.describe(announced_);
  }
  const VisionResult& result = next.result;
  if (broadcaster_.videoWanted()) {
    broadcaster_.publish(encodeVideo({result.frame.epoch, result.frame.id, result.frame.media_time,
                                      encodePicture(result.color, kJpegQuality)}));
  }
  broadcaster_.publish(encoder_.encode(result.frame));
}

void App::explain() {
  for (const auto& [id, lines] : vision_.plan()) {
    // A change that is taken back at once is not worth a line.
    auto& told = told_plans_[id];
    const MediaTime now = media_clock_.now();
    const bool same = std::equal(
        lines.begin(), lines.end(), told.lines.begin(), told.lines.end(),
        [](const PlanLine& a, const PlanLine& b) { return a.on == b.on && a.why == b.why; });
    if (same || (!told.lines.empty() && now - told.at < std::chrono::seconds(1))) continue;
    told = {lines, now};
    for (const PlanLine& line : lines) {
      const std::string_view stage = kStageNames[static_cast<std::size_t>(line.stage)];
      if (line.on) {
        spdlog::info("object {}: {:<8} on   {}; takes {:.1f} ms a frame", id, stage, line.why,
                     line.saves_ms);
      } else {
        spdlog::info(
            "object {}: {:<8} off  {}; saves {:.1f} ms and {:.0f} bytes a frame, costs "
            "{:.4f} N",
            id, stage, line.why, line.saves_ms, line.saves_bytes, line.costs_N);
      }
    }
  }
}

void App::sayWhatWasSkipped(const Pacer& pacer) {
  const MediaTime now = media_clock_.now();
  if (pacer.skipped() == told_skipped_ || now - told_at_ < std::chrono::seconds(1)) return;
  spdlog::warn("too slow for {:g} frames/s: {} frames skipped so far", source_->info().fps,
               pacer.skipped());
  told_skipped_ = pacer.skipped();
  told_at_ = now;
}

void App::waitUntil(MediaTime due) const {
  // In slices, so that stop() is heard.
  constexpr Duration kSlice = std::chrono::milliseconds(20);
  while (!stop_) {
    const Duration left = due - media_clock_.now();
    if (left <= Duration::zero()) return;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
}

}  // namespace hapticast::server
