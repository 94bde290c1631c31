// SPDX-License-Identifier: MIT
#include "server/pipeline/operator_requests.hpp"

#include <fmt/core.h>

#include <utility>

namespace hapticast::server {

namespace {

/// Replaces the values of `material` by those that `change` has.
void changeMaterial(const Material& change, Material& material) {
  for (const auto field :
       {&Material::stiffness_N_mm, &Material::damping_Ns_m, &Material::static_friction,
        &Material::dynamic_friction, &Material::texture_K_mm, &Material::mass_kg}) {
    if (change.*field) material.*field = change.*field;
  }
}

}  // namespace

void OperatorRequests::push(const Control& request, std::function<void()> confirm) {
  const std::lock_guard lock(mutex_);
  Control& merged = waiting_.request;
  if (request.paused) merged.paused = request.paused;
  if (request.seek_s) merged.seek_s = request.seek_s;
  changeMaterial(request.material, merged.material);
  waiting_.confirm.push_back(std::move(confirm));
}

void OperatorRequests::pushReload(VisionSettings reloaded) {
  const std::lock_guard lock(mutex_);
  reloaded_ = std::move(reloaded);
}

bool OperatorRequests::newerSeekWaits() {
  const std::lock_guard lock(mutex_);
  return waiting_.request.seek_s.has_value();
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
  Waiting carried_out;
  {
    const std::lock_guard lock(mutex_);
    carried_out = std::exchange(waiting_, {});
  }
  if (carried_out.confirm.empty()) return false;
  carryOut(carried_out.request, pump, counter, settings);
  for (const auto& confirm : carried_out.confirm) confirm();
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
    pump.seek(*next_s, [&] { return clock_.now() - begin < kNewerSeeks && newerSeekWaits(); });
    next_s.reset();
    if (clock_.now() - begin >= kNewerSeeks) return;
    const std::lock_guard lock(mutex_);
    next_s.swap(waiting_.request.seek_s);
  }
}

}  // namespace hapticast::server
