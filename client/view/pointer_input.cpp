// SPDX-License-Identifier: MIT
#include "client/view/pointer_input.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

constexpr double kNotch_mm = 1.0;  // chosen: per notch of the wheel

}  // namespace

void PointerInput::update(const TickReport& report, const ScenePlace& place, bool has_picture,
                          PointerTarget& target) {
  if (!waiting_ || !has_picture || !isMapped(report)) return;
  target.position_mm.head<2>() = place.toNominal(*waiting_);
  waiting_.reset();
  target.start_z_mm = place.workspace().depth_mm + kAboveRelief_mm;
  if (target.known) return;
  target.known = true;
  lift(target);
}

void PointerInput::press(double by_mm, PointerTarget& target) {
  if (!target.known || !std::isfinite(by_mm)) return;
  double& z_mm = target.position_mm.z();
  z_mm = std::clamp(z_mm - by_mm, kFarthest_mm, target.start_z_mm);
}

void PointerInput::turnWheel(double notches, PointerTarget& target) {
  press(-kNotch_mm * notches, target);
}

void PointerInput::lift(PointerTarget& target) {
  if (target.known) target.position_mm.z() = target.start_z_mm;
}

}  // namespace hapticast::client
