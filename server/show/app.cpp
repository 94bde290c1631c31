// SPDX-License-Identifier: MIT
#include "server/show/app.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/frame_pump.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/open_clip.hpp"
#include "server/pipeline/operator_requests.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/show/origin.hpp"
#include "server/source/stream_url.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

namespace {

// The protocol (proto/README.md) promises viewers a message about once a second.
constexpr Duration kPrepareEvery = std::chrono::seconds(1);

SourceInfo describeSource(const RgbdSource& source, const std::string& name) {
  SourceInfo info = source.info();
  if (!name.empty()) info.name = name;
  return info;
}

std::unique_ptr<RgbdSource> openFor(const Settings& settings, KeepWaiting keep_waiting) {
  if (settings.loop && isStreamUrl(settings.source))
    throw SourceError("--loop: a live stream has no end; leave the flag out");
  return openClip(settings, std::move(keep_waiting));
}

}  // namespace

class App::Impl {
 public:
  Impl(Settings settings, const Clock& clock, ReadSettings reread);

  void run();
  void stop() noexcept { stop_ = true; }
  [[nodiscard]] bool streaming() const { return streaming_; }

 private:
  void browse();
  void waitForViewer();
  void play(EncoderThread& encoder);
  void recordPlan(MediaTime now);
  /// Waits until `due` or until stop(). Returns whether the server goes on.
  bool waitUntil(MediaTime due);

  Settings settings_;
  LocalMediaClock media_clock_;
  std::atomic<bool> stop_{false};
  std::function<void()> while_waiting_;  // what goes on while the source waits for a child
  std::unique_ptr<RgbdSource> source_;
  Vision vision_;
  Reloader reloader_;  // used by the network thread only
  OperatorRequests requests_;
  const Clock& clock_;
  PipelineCounter counter_;
  Origin origin_;  // after what its port for operators reads
  StreamService& service_ = origin_.service();
  PlanLog plan_log_;
  DepthRangeLog range_log_;
  bool streaming_ = false;
};

App::Impl::Impl(Settings settings, const Clock& clock, ReadSettings reread)
    : settings_(std::move(settings)),
      media_clock_(clock),
      source_(openFor(settings_,
                      [this] {
                        if (while_waiting_) while_waiting_();
                        return !stop_;
                      })),
      vision_(describeSource(*source_, settings_.name),
              settings_.vision = preparePoints(settings_.vision, source_->info()), &clock),
      reloader_(settings_, std::move(reread), clock),
      requests_(clock),
      clock_(clock),
      counter_(clock),
      origin_(settings_, clock, media_clock_, vision_.description()) {}

void App::Impl::run() {
  origin_.start([this] { stop(); },
                [this] {
                  if (auto vision = reloader_.reload()) requests_.pushReload(std::move(*vision));
                },
                [this](const Control& control, std::function<void()> confirm) {
                  requests_.push(control, std::move(confirm));
                },
                [this](Metrics& metrics) { metrics.pipeline = counter_.counts(); });
  browse();
  const SliceSettings slices{.error_mm = computeHeightError_mm(settings_.vision)};
  if (settings_.vision.explain)
    spdlog::info("heights on the wire are exact to {:.3g} mm", slices.error_mm);
  EncoderThread encoder(origin_.sinks(), &origin_.signer(), slices,
                        settings_.http ? &clock_ : nullptr);
  if (!stop_) play(encoder);
  encoder.finish();
  service_.end();
}

void App::Impl::browse() {
  const SourceInfo& info = source_->info();
  if (settings_.vision.fov_deg && info.camera) {
    spdlog::info("--fov {:g}: replaces the source's own field of view ({:.1f} degrees)",
                 *settings_.vision.fov_deg, info.camera->degreesAcross(info.width_px));
  }
  const bool can_touch = warnOfUnlikelyInput(*source_, settings_.vision);
  MediaTime prepared_at{};
  double prepared_share = 0.0;
  const auto prepareViewers = [&](double share) {
    prepared_share = share;
    service_.open(vision_.description().name);
    service_.manager().reportAlive();
    const MediaTime now = media_clock_.now();
    if (prepared_at != MediaTime{} && now - prepared_at < kPrepareEvery) return;
    prepared_at = now;
    service_.broadcaster().prepare(share);
  };
  while_waiting_ = [&] { prepareViewers(prepared_share); };
  if (scanClip(vision_, *source_, media_clock_, stop_, prepareViewers))
    service_.broadcaster().describe(vision_.description());
  while_waiting_ = [this] { service_.manager().reportAlive(); };
  range_log_.log(vision_.mapped());
  if (!stop_ && !info.live && can_touch) warnOfNoObject(vision_, info.name);
}

void App::Impl::waitForViewer() {
  if (service_.broadcaster().viewers() > 0) return;
  counter_.enter(PipelinePhase::kWaitForViewer);
  spdlog::info("waiting for the first viewer");
  while (!stop_ && service_.broadcaster().viewers() == 0) waitUntil(media_clock_.now() + kSlice);
}

void App::Impl::play(EncoderThread& encoder) {
  const SourceInfo& info = source_->info();
  service_.open(vision_.description().name);
  if (settings_.wait_for_viewer) waitForViewer();
  spdlog::info("streaming {} ({} x {}, {:g} frames/s)", hideCredentials(settings_.source),
               info.width_px, info.height_px, info.fps);
  streaming_ = true;
  counter_.enter(PipelinePhase::kStream);
  FramePump pump(
      {*source_, vision_, encoder, clock_, media_clock_, settings_.http ? &counter_ : nullptr},
      settings_.loop, [this](MediaTime due) { return waitUntil(due); });
  std::uint64_t frames = 0;
  while (!stop_ && (settings_.frames == 0 || frames < settings_.frames)) {
    service_.manager().reportAlive();
    if (requests_.carryOut(pump, counter_, settings_.vision)) pump.resume();
    if (requests_.paused()) {
      pump.idle();
      continue;
    }
    const PumpStep step = pump.step();
    if (step == PumpStep::kEnd) break;
    if (step == PumpStep::kSilence) continue;
    ++frames;
    if (settings_.http)
      counter_.set(pump.skipped(), encoder.times(), origin_.signer().signingTime());
    range_log_.log(vision_.mapped());
    if (settings_.vision.explain)
      plan_log_.log(vision_.plan(), encoder.reliefBytes(), media_clock_.now());
    recordPlan(pump.lastPublished());
  }
  pump.flush();
  waitUntil(pump.lastPublished() + vision_.description().pipeline_latency + kPlayout);
}

void App::Impl::recordPlan(MediaTime now) {
  StreamRecorder* const recorder = origin_.recorder();
  if (recorder != nullptr && recorder->isPlanDue(now))
    recorder->pushPlan(encodePlan(vision_.plan()), now);
}

bool App::Impl::waitUntil(MediaTime due) {
  while (!stop_) {
    service_.manager().reportAlive();
    const Duration left = due - media_clock_.now();
    if (left <= Duration::zero()) break;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
  return !stop_;
}

App::App(Settings settings, const Clock& clock, ReadSettings reread)
    : impl_(std::make_unique<Impl>(std::move(settings), clock, std::move(reread))) {}

App::~App() = default;

void App::run() { impl_->run(); }

void App::stop() noexcept { impl_->stop(); }

bool App::streaming() const { return impl_->streaming(); }

}  // namespace hapticast::server
