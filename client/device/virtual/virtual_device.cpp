// SPDX-License-Identifier: MIT
#include "client/device/virtual/virtual_device.hpp"

#include <algorithm>
#include <utility>

#include "client/device/sleep_until.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
// Chosen: one second. During a longer standstill of the program the hand's motion is no touch.
constexpr int kLongestCatchUp_ticks = 1000;
}  // namespace

VirtualDevice::VirtualDevice(const PlantProfile& profile, const Hand& hand,
                             const Clock& clock) noexcept
    : profile_(profile),
      clock_(clock),
      axes_{AxisPlant(profile, hand), AxisPlant(profile, hand), AxisPlant(profile, hand)},
      delay_(static_cast<std::size_t>(std::clamp(profile.delay_ticks, 0, kLongestDelay_ticks))) {
  sent_N_.fill(Vec3::Zero());
  reset({0.0, 0.0, 30.0}, Vec3::Zero());
}

void VirtualDevice::lead(HandScript script, std::string name) {
  script_.emplace(std::move(script));
  led_by_ = std::move(name);
}

std::string VirtualDevice::description() const {
  return "virtual device (" + profile_.name + ") in a hand that " +
         (script_ ? "does: " + led_by_ : std::string("rests"));
}

void VirtualDevice::waitForTick(LocalTime deadline) noexcept {
  if (clock_.now() >= deadline) return;
  sleepUntil(deadline);
}

DeviceState VirtualDevice::exchange(const Vec3& force_N, const TickReport& report) noexcept {
  advanceScript(report);
  const int ticks = ticksSinceLast();
  const Vec3 velocity_mm_s = (target_mm_ - last_target_mm_) / (ticks * kTick_s);
  for (int i = 0; i < ticks; ++i) {
    newest_ = (newest_ + 1) % sent_N_.size();
    sent_N_[newest_] = force_N;
    const Vec3& acting_N = sent_N_[(newest_ + sent_N_.size() - delay_) % sent_N_.size()];
    advance(acting_N, last_target_mm_ + velocity_mm_s * (i * kTick_s), velocity_mm_s);
  }
  last_target_mm_ = target_mm_;
  DeviceState state;
  // The simulated hand always holds the enabling button.
  if (profile_.enable_button) state.buttons = std::uint32_t{1} << *profile_.enable_button;
  state.position_mm = truePosition_mm();
  const double count_mm = profile_.count_mm;
  if (count_mm > 0.0) state.position_mm = (state.position_mm / count_mm).array().round() * count_mm;
  state.time = time_;
  return state;
}

/// Returns the whole ticks of the clock since the last call, at least one. An early or late call
/// within a tick must neither skip a tick nor repeat one.
int VirtualDevice::ticksSinceLast() noexcept {
  const LocalTime now = clock_.now();
  if (!running_) {
    running_ = true;
    time_ = now - kTickPeriod;
  }
  const auto ticks = std::max<std::int64_t>((now - time_) / kTickPeriod, 1);
  if (ticks > kLongestCatchUp_ticks) {
    time_ = now;
    return kLongestCatchUp_ticks;
  }
  time_ += ticks * kTickPeriod;
  return static_cast<int>(ticks);
}

void VirtualDevice::advance(const Vec3& force_N, const Vec3& target_from_mm,
                            const Vec3& target_velocity_mm_s) noexcept {
  for (int i = 0; i < 3; ++i) {
    axes_[static_cast<std::size_t>(i)].advance(force_N[i] + push_N_[i], target_from_mm[i] * 1e-3,
                                               target_velocity_mm_s[i] * 1e-3);
  }
}

void VirtualDevice::advanceScript(const TickReport& report) noexcept {
  if (!script_) return;
  if (report.tick == seen_tick_) return;  // the script advances with the ticks of the loop
  seen_tick_ = report.tick;
  const Vec3 start_mm = report.mapping.toNominal(truePosition_mm());
  target_mm_ = report.mapping.toDevice(script_->next(report, start_mm));
}

void VirtualDevice::reset(const Vec3& position_mm, const Vec3& velocity_mm_s) noexcept {
  for (int i = 0; i < 3; ++i) {
    axes_[static_cast<std::size_t>(i)].reset(position_mm[i] * 1e-3, velocity_mm_s[i] * 1e-3);
  }
  target_mm_ = last_target_mm_ = position_mm;
}

Vec3 VirtualDevice::truePosition_mm() const noexcept {
  return 1e3 * Vec3(axes_[0].position_m(), axes_[1].position_m(), axes_[2].position_m());
}

Vec3 VirtualDevice::trueVelocity_mm_s() const noexcept {
  return 1e3 * Vec3(axes_[0].velocity_m_s(), axes_[1].velocity_m_s(), axes_[2].velocity_m_s());
}

}  // namespace hapticast::client
