// SPDX-License-Identifier: MIT
#include "server/show/producers.hpp"

#include <spdlog/spdlog.h>

#include <cstdint>
#include <functional>
#include <optional>

#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/frame_pump.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/open_clip.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/show/show.hpp"
#include "server/source/stream_url.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

namespace {

// The protocol (proto/README.md) promises viewers a message about once a second.
constexpr Duration kPrepareEvery = std::chrono::seconds(1);

/// Source and vision run on the thread of the show, the encoding on a second one (EncoderThread).
class ClipProducer final : public Producer {
 public:
  ClipProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override { return vision_.description(); }
  void connect(Show& show) override;
  [[nodiscard]] OperatedStream* operated() override { return pump_ ? &*pump_ : nullptr; }
  void prepare() override;
  void start() override;
  bool step() override;
  bool finish() override;
  void release() noexcept override;

 private:
  void onFrame();

  const Settings& settings_;
  const Clock& clock_;
  LocalMediaClock media_clock_;
  std::function<void()> while_waiting_;  // what goes on while the source waits for a child
  std::unique_ptr<RgbdSource> source_;
  VisionSettings vision_settings_;
  Vision vision_;
  PlanLog plan_log_;
  DepthRangeLog range_log_;
  std::optional<EncoderThread> encoder_;
  std::optional<FramePump> pump_;
  std::uint64_t frames_ = 0;
};

std::unique_ptr<RgbdSource> openFor(const Settings& settings, const KeepWaiting& keep_waiting) {
  if (settings.loop && isStreamUrl(settings.source))
    throw SourceError("--loop: a live stream has no end; leave the flag out");
  return openClip(settings, keep_waiting);
}

ClipProducer::ClipProducer(const Settings& settings, const Clock& clock)
    : settings_(settings),
      clock_(clock),
      media_clock_(clock),
      source_(openFor(settings_,
                      [this] {
                        if (while_waiting_) while_waiting_();
                        return show_ == nullptr || !show_->stopped();
                      })),
      vision_settings_(preparePoints(settings_.vision, source_->info())),
      vision_(describeSource(*source_, settings_), vision_settings_, &clock) {}

void ClipProducer::connect(Show& show) {
  Producer::connect(show);
  const SliceSettings slices{.error_mm = computeHeightError_mm(vision_settings_)};
  encoder_.emplace(show.sinks().all(), &show.sinks().signer(), slices,
                   settings_.http ? &clock_ : nullptr);
  pump_.emplace(FramePump::Parts{*source_, vision_, vision_settings_, *encoder_, clock_,
                                 media_clock_, settings_.http ? &show.counter() : nullptr},
                settings_.loop, [&show](MediaTime due) { return show.waitUntil(due); });
}

void ClipProducer::prepare() {
  const SourceInfo& info = source_->info();
  if (vision_settings_.fov_deg && info.camera) {
    spdlog::info("--fov {:g}: replaces the source's own field of view ({:.1f} degrees)",
                 *vision_settings_.fov_deg, info.camera->degreesAcross(info.width_px));
  }
  const bool can_touch = warnOfUnlikelyInput(*source_, vision_settings_);
  StreamService& service = show_->sinks().service();
  MediaTime prepared_at{};
  double prepared_share = 0.0;
  const auto prepareViewers = [&](double share) {
    prepared_share = share;
    service.open(vision_.description().name);
    service.manager().reportAlive();
    const MediaTime now = media_clock_.now();
    if (prepared_at == MediaTime{} || now - prepared_at >= kPrepareEvery) {
      prepared_at = now;
      service.broadcaster().prepare(share);
    }
    return !show_->stopped();
  };
  while_waiting_ = [&] { (void)prepareViewers(prepared_share); };
  if (scanClip(vision_, *source_, media_clock_, prepareViewers))
    service.broadcaster().describe(vision_.description());
  while_waiting_ = [&service] { service.manager().reportAlive(); };
  range_log_.log(vision_.mapped());
  if (!show_->stopped() && !info.live && can_touch) warnOfNoObject(vision_, info.name);
  if (vision_settings_.explain)
    spdlog::info("heights on the wire are exact to {:.3g} mm",
                 computeHeightError_mm(vision_settings_));
}

void ClipProducer::start() {
  const SourceInfo& info = source_->info();
  spdlog::info("streaming {} ({} x {}, {:g} frames/s)", hideCredentials(settings_.source),
               info.width_px, info.height_px, info.fps);
  pump_->resume();
}

bool ClipProducer::step() {
  if (settings_.frames != 0 && frames_ >= settings_.frames) return false;
  const PumpStep step = pump_->step();
  if (step == PumpStep::kFrame) onFrame();
  return step != PumpStep::kEnd;
}

void ClipProducer::onFrame() {
  ++frames_;
  if (settings_.http)
    show_->counter().set(pump_->skipped(), encoder_->times(),
                         show_->sinks().signer().signingTime());
  range_log_.log(vision_.mapped());
  if (vision_settings_.explain)
    plan_log_.log(vision_.plan(), encoder_->reliefBytes(), media_clock_.now());
  const MediaTime published = pump_->lastPublished();
  StreamRecorder* const recorder = show_->sinks().recorder();
  if (recorder != nullptr && recorder->isPlanDue(published))
    recorder->pushPlan(encodePlan(vision_.plan()), published);
}

bool ClipProducer::finish() {
  pump_->flush();
  (void)show_->waitUntil(pump_->lastPublished() + vision_.description().pipeline_latency +
                         Show::kPlayout);
  encoder_->finish();
  return true;
}

void ClipProducer::release() noexcept {
  while_waiting_ = nullptr;
  pump_.reset();
  encoder_.reset();
}

}  // namespace

std::unique_ptr<Producer> makeClipProducer(const Settings& settings, const Clock& clock) {
  return std::make_unique<ClipProducer>(settings, clock);
}

}  // namespace hapticast::server
