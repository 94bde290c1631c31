// SPDX-License-Identifier: MIT
#include "server/pipeline/frame_pump.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/pipeline/control_queue.hpp"

namespace hapticast::server {

namespace {

// Silence of a live source, beyond the look-ahead, that ends the wait for its next frame; chosen.
constexpr Duration kHoldBack = std::chrono::milliseconds(200);
constexpr Duration kIdle = std::chrono::milliseconds(20);  // chosen: of a paused clip

}  // namespace

FramePump::FramePump(const Parts& parts, bool loop, Wait wait)
    : parts_(parts),
      loop_(loop),
      wait_(std::move(wait)),
      pacer_(parts.source.info().fps, parts.media_clock.now()) {}

PumpStep FramePump::step() {
  const auto frame = readFrame();
  if (frame) {
    process(*frame);
    logSkippedFrames();
    return PumpStep::kFrame;
  }
  if (!isLive()) return PumpStep::kEnd;
  publishHeldBack();
  return PumpStep::kSilence;
}

std::optional<RgbdFrame> FramePump::readFrame() {
  if (isLive()) return parts_.source.read();
  Pacer::Plan plan = pacer_.plan(parts_.media_clock.now());
  const bool goes_on = wait_(plan.due);
  // A machine that stood still wakes long after the frame was due.
  if (goes_on) plan = pacer_.plan(parts_.media_clock.now());
  return readSkipping(parts_.source, plan.skip, loop_ && goes_on);
}

MediaTime FramePump::findMediaTime(const RgbdFrame& frame) {
  if (!isLive()) return pacer_.frameRead(frame.epoch, frame.index);
  // Ages are measured before now(), so two frames could change their order.
  last_captured_ = std::max(parts_.media_clock.now() - frame.age, last_captured_ + kTickPeriod);
  return last_captured_;
}

void FramePump::process(const RgbdFrame& frame) {
  const MediaTime media_time = findMediaTime(frame);
  const LocalTime begin = parts_.clock.now();
  auto result = parts_.vision.push(frame, media_time);
  if (parts_.counter != nullptr)
    parts_.counter->addFrame(parts_.clock.now() - begin, parts_.vision.plan());
  if (result) publish(std::move(*result));
}

void FramePump::publish(VisionResult result) {
  last_published_ = result.frame.media_time;
  parts_.encoder.push(parts_.vision.description(), std::move(result));
}

void FramePump::publishHeldBack() {
  const Duration silence = parts_.media_clock.now() - last_captured_;
  if (silence >= parts_.vision.description().pipeline_latency + kHoldBack) flush();
}

void FramePump::flush() {
  for (VisionResult& result : parts_.vision.flush()) publish(std::move(result));
}

void FramePump::idle() {
  const MediaTime now = parts_.media_clock.now();
  const bool live = isLive();
  if (wait_(live ? now : now + kIdle) && live) (void)parts_.source.read();
  resume();
}

void FramePump::seek(double time_s, const std::function<bool()>& ends_early) {
  const SourceInfo& info = parts_.source.info();
  flush();
  parts_.vision.beginAnew();
  const std::uint64_t last = info.frame_count.value_or(1) - 1;
  const auto frames = std::min(static_cast<std::uint64_t>(std::llround(time_s * info.fps)), last);
  const MediaTime begin =
      parts_.media_clock.now() - fromSeconds(static_cast<double>(frames) / info.fps);
  parts_.source.rewind();
  for (std::uint64_t i = 0; i < frames && wait_(begin) && !ends_early(); ++i) {
    const auto frame = parts_.source.read();
    if (!frame) break;
    (void)parts_.vision.push(*frame, begin + fromSeconds(static_cast<double>(i) / info.fps));
  }
  (void)parts_.vision.flush();
  resume();
}

void FramePump::changeMaterials(const Material& change) {
  VisionSettings& settings = parts_.settings;
  changeMaterial(change, settings.material);
  for (AuthorObject& object : settings.objects) changeMaterial(change, object.material);
  setMaterials();
}

void FramePump::applyReload(const VisionSettings& reloaded) {
  parts_.settings.material = reloaded.material;
  parts_.settings.mass_kg = reloaded.mass_kg;
  parts_.settings.objects = reloaded.objects;
  setMaterials();
}

void FramePump::setMaterials() {
  parts_.vision.setMaterials(parts_.settings);
  parts_.encoder.setSlices({.error_mm = computeHeightError_mm(parts_.settings)});
}

void FramePump::logSkippedFrames() {
  const MediaTime now = parts_.media_clock.now();
  // First after a second, then once a minute with the sum.
  const Duration pause = logged_skipped_ == 0 ? std::chrono::seconds(1) : std::chrono::minutes(1);
  if (pacer_.skipped() == logged_skipped_ || now - last_logged_ < pause) return;
  spdlog::warn("the server is too slow for {:g} frames/s: {} frames skipped so far",
               parts_.source.info().fps, pacer_.skipped());
  logged_skipped_ = pacer_.skipped();
  last_logged_ = now;
}

}  // namespace hapticast::server
