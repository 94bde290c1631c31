// SPDX-License-Identifier: MIT
#include "server/pipeline/operator_requests.hpp"

#include <fmt/core.h>

#include <utility>

namespace hapticast::server {

void OperatorRequests::pushReload(VisionSettings reloaded) {
  const std::lock_guard lock(mutex_);
  reloaded_ = std::move(reloaded);
}

void OperatorRequests::applyReload(FramePump& pump, VisionSettings& settings) {
  std::optional<VisionSettings> reloaded;
  {
    const std::lock_guard lock(mutex_);
    reloaded.swap(reloaded_);
  }
  if (!reloaded) return;
  settings.material = reloaded->material;
  settings.mass_kg = reloaded->mass_kg;
  settings.objects = reloaded->objects;
  pump.setMaterials(settings);
}

bool OperatorRequests::carryOut(FramePump& pump, PipelineCounter& counter,
                                VisionSettings& settings) {
  applyReload(pump, settings);
  const auto merged = queue_.take();
  if (!merged) return false;
  carryOut(merged->request, pump, counter, settings);
  merged->confirmAll();
  return true;
}

void OperatorRequests::carryOut(const Control& request, FramePump& pump, PipelineCounter& counter,
                                VisionSettings& settings) {
  if (request.paused && *request.paused != paused_)
    log_.info(fmt::format("an operator {} the stream", *request.paused ? "pauses" : "continues"));
  if (request.paused.value_or(false)) pump.flush();
  paused_ = request.paused.value_or(paused_);
  if (request.seek_s) seek(*request.seek_s, pump, counter);
  counter.enter(paused_ ? PipelinePhase::kPause : PipelinePhase::kStream);
  if (request.material == Material{}) return;
  changeMaterial(request.material, settings.material);
  for (AuthorObject& object : settings.objects) changeMaterial(request.material, object.material);
  pump.setMaterials(settings);
  log_.info("an operator changes the material");
}

void OperatorRequests::seek(double time_s, FramePump& pump, PipelineCounter& counter) {
  if (pump.isLive()) return log_.info("an operator seeks, but a live source has no other times");
  counter.enter(PipelinePhase::kSeek);
  const LocalTime begin = clock_.now();
  for (std::optional<double> next_s = time_s; next_s;) {
    log_.info(fmt::format("an operator seeks to {:g} s", *next_s));
    pump.seek(*next_s, [&] { return clock_.now() - begin < kNewerSeeks && queue_.seekWaits(); });
    if (clock_.now() - begin >= kNewerSeeks) return;
    next_s = queue_.takeSeek();
  }
}

}  // namespace hapticast::server
