// SPDX-License-Identifier: MIT
#include "server/pipeline/operator_requests.hpp"

#include <spdlog/spdlog.h>

#include <cstddef>
#include <utility>

namespace hapticast::server {

namespace {

constexpr std::size_t kMostRequests = 100;  // chosen: of operators, in one frame time

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

void OperatorRequests::push(const Control& request) {
  const std::lock_guard lock(mutex_);
  if (requests_.size() < kMostRequests) requests_.push_back(request);
}

void OperatorRequests::pushReload(VisionSettings reloaded) {
  const std::lock_guard lock(mutex_);
  reloaded_ = std::move(reloaded);
}

bool OperatorRequests::carryOut(FramePump& pump, PipelineCounter& counter,
                                VisionSettings& settings) {
  std::vector<Control> requests;
  std::optional<VisionSettings> reloaded;
  {
    const std::lock_guard lock(mutex_);
    requests.swap(requests_);
    reloaded.swap(reloaded_);
  }
  if (reloaded) {
    settings.material = reloaded->material;
    settings.mass_kg = reloaded->mass_kg;
    settings.objects = reloaded->objects;
    pump.setMaterials(settings);
  }
  for (const Control& request : requests) carryOut(request, pump, counter, settings);
  return !requests.empty();
}

void OperatorRequests::carryOut(const Control& request, FramePump& pump, PipelineCounter& counter,
                                VisionSettings& settings) {
  if (request.paused && *request.paused != paused_)
    spdlog::info("an operator {} the stream", *request.paused ? "pauses" : "continues");
  if (request.paused.value_or(false)) pump.flush();
  paused_ = request.paused.value_or(paused_);
  if (request.seek_s) {
    counter.enter(PipelinePhase::kScan);
    pump.seek(*request.seek_s);
  }
  counter.enter(paused_ ? PipelinePhase::kPause : PipelinePhase::kStream);
  if (request.material == Material{}) return;
  changeMaterials(request.material, settings);
  pump.setMaterials(settings);
  spdlog::info("an operator changes the material");
}

}  // namespace hapticast::server
