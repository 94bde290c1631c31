// SPDX-License-Identifier: MIT
#include "server/app.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/pipeline/clip_scan.hpp"
#include "server/pipeline/encoder_thread.hpp"
#include "server/pipeline/input_check.hpp"
#include "server/pipeline/pipeline_counter.hpp"
#include "server/pipeline/plan_log.hpp"
#include "server/relay/relay_publisher.hpp"
#include "server/source/key_mask_source.hpp"
#include "server/source/pacer.hpp"
#include "server/source/stream_url.hpp"
#include "server/stream/signing_key_file.hpp"
#include "server/stream_service.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

namespace {

// Time for viewers to play the end of a clip before the goodbye.
constexpr Duration kPlayout = std::chrono::milliseconds(500);
// The protocol (proto/README.md) promises viewers a message about once a second.
constexpr Duration kPrepareEvery = std::chrono::seconds(1);
// Silence of a live source, beyond the lookahead, that ends the wait for its next frame; chosen.
constexpr Duration kHoldBack = std::chrono::milliseconds(200);
// Interval in which waiting code checks stop(); chosen.
constexpr Duration kSlice = std::chrono::milliseconds(20);
constexpr std::size_t kMostRequests = 100;  // chosen: of operators, in one frame time

SourceInfo describeSource(const RgbdSource& source, const std::string& name) {
  SourceInfo info = source.info();
  if (!name.empty()) info.name = name;
  return info;
}

std::unique_ptr<RgbdSource> openFor(const Settings& settings) {
  if (settings.loop && isStreamUrl(settings.source))
    throw SourceError("--loop: a live stream has no end; leave the flag out");
  return addKeyMasks(
      openSource(settings.source, settings.fps, settings.to_and_fro, settings.layout),
      settings.key_masks);
}

/// Returns the keys of origins that this one makes room for: all, unless the user named keys or has
/// a key of its own.
std::vector<KeyBytes> trustedOrigins(const Settings& settings, const FrameSigner& signer) {
  std::vector<KeyBytes> keys = settings.origin_keys;
  if (!keys.empty() || !settings.signing_key_file.empty())
    keys.push_back(signer.identity().verifying_key);
  return keys;
}

/// Replaces the values of all objects by those that `change` has.
void changeMaterials(const Material& change, VisionSettings& vision) {
  const auto replace = [&change](Material& material) {
    for (const auto field :
         {&Material::stiffness_N_mm, &Material::damping_Ns_m, &Material::static_friction,
          &Material::dynamic_friction, &Material::texture_K_mm, &Material::mass_kg}) {
      if (change.*field) material.*field = change.*field;
    }
  };
  replace(vision.material);
  for (AuthorObject& object : vision.objects) replace(object.material);
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
  [[nodiscard]] std::optional<RgbdFrame> nextFrame(Pacer& pacer);
  MediaTime findMediaTime(const RgbdFrame& frame, Pacer& pacer);
  /// Publishes what vision holds back for its window if the live source is silent. After the
  /// silence these frames would be so late that viewers would raise their playout delay for them.
  void publishHeldBack(EncoderThread& encoder);
  /// Publishes all frames that vision holds back for its window.
  void flushVision(EncoderThread& encoder);
  void publish(VisionResult result, EncoderThread& encoder);
  /// Reads the settings again. Thread: the network's.
  void reload();
  /// Applies the materials of the last reload(), if there was one.
  void adoptMaterials(EncoderThread& encoder);
  /// Carries out what operators requested since the last call. Returns false if that was nothing.
  bool carryOutRequests(EncoderThread& encoder);
  /// Continues with the frame at `time_s` of the clip. Vision processes all frames before it again,
  /// without publishing them, because it follows the objects from the first frame on.
  void seek(double time_s, EncoderThread& encoder);
  /// Waits a moment, or drops a frame of a live source.
  void idle();
  /// Passes the frame to vision, and publishes what that completes.
  void process(const RgbdFrame& frame, MediaTime media_time, EncoderThread& encoder);
  void logSkippedFrames(const Pacer& pacer);
  void waitUntil(MediaTime due);

  Settings settings_;
  LocalMediaClock media_clock_;
  std::unique_ptr<RgbdSource> source_;
  Vision vision_;
  FrameSigner signer_;  // outlives all encoded frames
  Reloader reloader_;   // used by the network thread only
  std::mutex mutex_;
  std::optional<VisionSettings> reloaded_;  // guarded by mutex_
  std::vector<Control> requests_;           // of operators; guarded by mutex_
  bool paused_ = false;
  const Clock& clock_;
  PipelineCounter counter_;
  std::optional<RelayPublisher> relay_;
  StreamService service_;  // after what its port for operators reads
  PlanLog plan_log_;
  DepthRangeLog range_log_;
  std::atomic<bool> stop_{false};
  bool streaming_ = false;
  MediaTime last_published_{};
  MediaTime last_captured_{};  // of a live source
  std::uint64_t logged_skipped_ = 0;
  MediaTime last_logged_{};
};

App::Impl::Impl(Settings settings, const Clock& clock, ReadSettings reread)
    : settings_(std::move(settings)),
      media_clock_(clock),
      source_(openFor(settings_)),
      vision_(describeSource(*source_, settings_.name),
              settings_.vision = preparePoints(settings_.vision, source_->info()), &clock),
      signer_(settings_.signing_key_file.empty() ? SigningKey()
                                                 : loadSigningKey(settings_.signing_key_file),
              settings_.tls.wanted() ? std::make_unique<DatagramSealer>(clock) : nullptr),
      reloader_(settings_, std::move(reread)),
      clock_(clock),
      counter_(clock),
      service_(settings_, clock, media_clock_, vision_.description(), signer_.identity()) {
  // Viewers of relays need the key: a relay could show another one.
  if (settings_.publish || !settings_.signing_key_file.empty())
    spdlog::info("origin key: {}", toHex(signer_.identity().verifying_key));
  if (settings_.publish)
    relay_.emplace(*settings_.publish, settings_.nats, clock, media_clock_, signer_,
                   trustedOrigins(settings_, signer_));
  if (settings_.http) signer_.measure(clock);
  service_.watch([this](Metrics& metrics) {
    metrics.pipeline = counter_.counts();
    if (relay_) metrics.relay = relay_->counts();
  });
}

void App::Impl::run() {
  service_.broadcaster().onRemoved([this] { signer_.revokeKey(); });
  service_.broadcaster().onControl([this](const Control& control) {
    const std::lock_guard lock(mutex_);
    if (requests_.size() < kMostRequests) requests_.push_back(control);
  });
  service_.start([this] { stop(); }, [this] { reload(); });
  browse();
  const SliceSettings slices{.error_mm = heightError_mm(settings_.vision)};
  if (settings_.vision.explain)
    spdlog::info("heights on the wire are exact to {:.3g} mm", slices.error_mm);
  std::vector<StreamSink*> sinks{&service_.broadcaster()};
  if (relay_) sinks.push_back(&*relay_);
  EncoderThread encoder(std::move(sinks), &signer_, slices, settings_.http ? &clock_ : nullptr);
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
  MediaTime last_report{};
  const auto report = [&](double share) {
    service_.open(vision_.description().name);
    service_.manager().reportAlive();
    const MediaTime now = media_clock_.now();
    if (last_report != MediaTime{} && now - last_report < kPrepareEvery) return;
    last_report = now;
    service_.broadcaster().prepare(share);
  };
  if (scanClip(vision_, *source_, media_clock_, stop_, report))
    service_.broadcaster().describe(vision_.description());
  range_log_.log(vision_.mapped());
  if (stop_ || info.live || vision_.mapped() || !can_touch) return;
  spdlog::warn(
      "--source {}: no object was found, so there is nothing to touch; name one with --object U,V",
      info.name);
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
  Pacer pacer(info.fps, media_clock_.now());
  std::uint64_t frames = 0;
  while (!stop_ && (settings_.frames == 0 || frames < settings_.frames)) {
    service_.manager().reportAlive();
    adoptMaterials(encoder);
    if (carryOutRequests(encoder)) pacer.resume(media_clock_.now());
    if (paused_) {
      idle();
      pacer.resume(media_clock_.now());
      continue;
    }
    const auto frame = nextFrame(pacer);
    if (!frame && info.live) {
      publishHeldBack(encoder);
      continue;
    }
    if (!frame) break;
    const MediaTime media_time = findMediaTime(*frame, pacer);
    ++frames;
    process(*frame, media_time, encoder);
    if (settings_.http) counter_.set(pacer.skipped(), encoder.times(), signer_.signingTime());
    range_log_.log(vision_.mapped());
    if (settings_.vision.explain)
      plan_log_.log(vision_.plan(), encoder.reliefBytes(), media_clock_.now());
    logSkippedFrames(pacer);
  }
  flushVision(encoder);
  waitUntil(last_published_ + vision_.description().pipeline_latency + kPlayout);
}

std::optional<RgbdFrame> App::Impl::nextFrame(Pacer& pacer) {
  if (source_->info().live) return source_->read();
  const Pacer::Plan plan = pacer.plan(media_clock_.now());
  waitUntil(plan.due);
  return readSkipping(*source_, plan.skip, settings_.loop && !stop_);
}

MediaTime App::Impl::findMediaTime(const RgbdFrame& frame, Pacer& pacer) {
  if (!source_->info().live) return pacer.frameRead(frame.epoch, frame.index);
  // Ages are measured before now(), so two frames could change their order.
  last_captured_ = std::max(media_clock_.now() - frame.age, last_captured_ + kTickPeriod);
  return last_captured_;
}

void App::Impl::process(const RgbdFrame& frame, MediaTime media_time, EncoderThread& encoder) {
  const LocalTime begin = clock_.now();
  auto result = vision_.push(frame, media_time);
  if (settings_.http) counter_.addFrame(clock_.now() - begin, vision_.plan());
  if (result) publish(std::move(*result), encoder);
}

void App::Impl::publishHeldBack(EncoderThread& encoder) {
  const Duration silence = media_clock_.now() - last_captured_;
  if (silence < vision_.description().pipeline_latency + kHoldBack) return;
  flushVision(encoder);
}

void App::Impl::flushVision(EncoderThread& encoder) {
  for (VisionResult& result : vision_.flush()) publish(std::move(result), encoder);
}

void App::Impl::publish(VisionResult result, EncoderThread& encoder) {
  last_published_ = result.frame.media_time;
  encoder.push(vision_.description(), std::move(result));
}

void App::Impl::reload() {
  auto vision = reloader_.reload();
  const std::lock_guard lock(mutex_);
  if (vision) reloaded_ = std::move(vision);
}

void App::Impl::adoptMaterials(EncoderThread& encoder) {
  const std::lock_guard lock(mutex_);
  if (!reloaded_) return;
  settings_.vision.material = reloaded_->material;
  settings_.vision.mass_kg = reloaded_->mass_kg;
  settings_.vision.objects = reloaded_->objects;
  reloaded_.reset();
  vision_.setMaterials(settings_.vision);
  encoder.setSlices({.error_mm = heightError_mm(settings_.vision)});
}

bool App::Impl::carryOutRequests(EncoderThread& encoder) {
  std::vector<Control> requests;
  {
    const std::lock_guard lock(mutex_);
    requests.swap(requests_);
  }
  for (const Control& request : requests) {
    if (request.paused && *request.paused != paused_)
      spdlog::info("an operator {} the stream", *request.paused ? "pauses" : "continues");
    if (request.paused.value_or(false)) flushVision(encoder);
    paused_ = request.paused.value_or(paused_);
    if (request.seek_s) {
      counter_.enter(PipelinePhase::kScan);
      seek(*request.seek_s, encoder);
    }
    counter_.enter(paused_ ? PipelinePhase::kPause : PipelinePhase::kStream);
    if (request.material != Material{}) {
      changeMaterials(request.material, settings_.vision);
      vision_.setMaterials(settings_.vision);
      encoder.setSlices({.error_mm = heightError_mm(settings_.vision)});
      spdlog::info("an operator changes the material");
    }
  }
  return !requests.empty();
}

void App::Impl::seek(double time_s, EncoderThread& encoder) {
  const SourceInfo& info = source_->info();
  if (info.live) {
    spdlog::warn("an operator seeks, but a live source has no other times");
    return;
  }
  spdlog::info("an operator seeks to {:g} s", time_s);
  flushVision(encoder);
  vision_.beginAnew();
  const std::uint64_t last = info.frame_count.value_or(1) - 1;
  const auto frames = std::min(static_cast<std::uint64_t>(std::llround(time_s * info.fps)), last);
  const MediaTime begin = media_clock_.now() - fromSeconds(static_cast<double>(frames) / info.fps);
  source_->rewind();
  for (std::uint64_t i = 0; i < frames && !stop_; ++i) {
    service_.manager().reportAlive();
    const auto frame = source_->read();
    if (!frame) break;
    (void)vision_.push(*frame, begin + fromSeconds(static_cast<double>(i) / info.fps));
  }
  (void)vision_.flush();
}

void App::Impl::idle() {
  if (source_->info().live) {
    service_.manager().reportAlive();
    (void)source_->read();
  } else {
    waitUntil(media_clock_.now() + kSlice);
  }
}

void App::Impl::logSkippedFrames(const Pacer& pacer) {
  const MediaTime now = media_clock_.now();
  // First after a second, then once a minute with the sum.
  const Duration pause = logged_skipped_ == 0 ? std::chrono::seconds(1) : std::chrono::minutes(1);
  if (pacer.skipped() == logged_skipped_ || now - last_logged_ < pause) return;
  spdlog::warn("the server is too slow for {:g} frames/s: {} frames skipped so far",
               source_->info().fps, pacer.skipped());
  logged_skipped_ = pacer.skipped();
  last_logged_ = now;
}

void App::Impl::waitUntil(MediaTime due) {
  while (!stop_) {
    service_.manager().reportAlive();
    const Duration left = due - media_clock_.now();
    if (left <= Duration::zero()) return;
    std::this_thread::sleep_for(std::min(left, kSlice));
  }
}

App::App(Settings settings, const Clock& clock, ReadSettings reread)
    : impl_(std::make_unique<Impl>(std::move(settings), clock, std::move(reread))) {}

App::~App() = default;

void App::run() { impl_->run(); }

void App::stop() noexcept { impl_->stop(); }

bool App::streaming() const { return impl_->streaming(); }

}  // namespace hapticast::server
