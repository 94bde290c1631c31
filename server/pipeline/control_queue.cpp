// SPDX-License-Identifier: MIT
#include "server/pipeline/control_queue.hpp"

#include <utility>

namespace hapticast::server {

void changeMaterial(const Material& change, Material& material) {
  for (const auto field :
       {&Material::stiffness_N_mm, &Material::damping_Ns_m, &Material::static_friction,
        &Material::dynamic_friction, &Material::texture_K_mm, &Material::mass_kg}) {
    if (change.*field) material.*field = change.*field;
  }
}

void ControlQueue::push(const Control& request, std::function<void()> confirm) {
  const std::lock_guard lock(mutex_);
  Control& merged = merged_.request;
  if (request.paused) merged.paused = request.paused;
  if (request.seek_s) merged.seek_s = request.seek_s;
  if (request.speed) merged.speed = request.speed;
  changeMaterial(request.material, merged.material);
  merged_.confirm.push_back(std::move(confirm));
}

std::optional<ControlQueue::Merged> ControlQueue::take() {
  const std::lock_guard lock(mutex_);
  if (merged_.confirm.empty()) return std::nullopt;
  return std::exchange(merged_, {});
}

bool ControlQueue::waits() const {
  const std::lock_guard lock(mutex_);
  return !merged_.confirm.empty();
}

bool ControlQueue::seekWaits() const {
  const std::lock_guard lock(mutex_);
  return merged_.request.seek_s.has_value();
}

std::optional<double> ControlQueue::takeSeek() {
  const std::lock_guard lock(mutex_);
  return std::exchange(merged_.request.seek_s, std::nullopt);
}

}  // namespace hapticast::server
