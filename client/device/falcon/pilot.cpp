// SPDX-License-Identifier: MIT
#include "client/device/falcon/pilot.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "client/device/falcon/kinematics.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
constexpr Duration kBlink = std::chrono::milliseconds(250);  // chosen: twice a second
}  // namespace

void FalconPilot::onReply(const FalconReply& reply, LocalTime at) noexcept {
  buttons_ = reply.buttons;
  if (phase_ == Phase::kAway) phase_ = Phase::kHoming;
  if (forget_ > 0) return;
  if (reply.homed != kAllHomed) {
    phase_ = Phase::kHoming;
    homed_replies_ = 0;
    must_forget_ = false;
  } else if (phase_ == Phase::kHoming) {
    if (!must_forget_) home(reply, at);
  } else if (!processReply(reply, at)) {
    rejectPosition();
  }
}

/// Waits for the end of the homing. The counters restart while the axes pass their marks, so no
/// comparison is possible.
void FalconPilot::home(const FalconReply& reply, LocalTime at) noexcept {
  if (++homed_replies_ < kHomedReplies) return;
  const auto position_m = falconForward_m(falconAngles_rad(reply.encoders), kFalconCentre_m);
  if (!position_m) return;
  homed_replies_ = 0;
  rejected_ = 0;
  last_ = reply;
  accepted_ = at;
  position_m_ = *position_m;
  phase_ = Phase::kOutside;
}

/// Accepts the position of a reply. Returns false if it is implausible.
bool FalconPilot::processReply(const FalconReply& reply, LocalTime at) noexcept {
  const Duration since = at - accepted_;
  // Only a silence allows a larger step: rejected replies were no silence.
  if (rejected_ == 0)
    gap_ms_ =
        std::clamp<std::int64_t>((since + kTickPeriod / 2) / kTickPeriod, 1, kSilent / kTickPeriod);
  const auto most = kFastest_per_ms * gap_ms_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(reply.encoders[axis] - last_.encoders[axis]) > most) return false;
  }
  const auto position_m = falconForward_m(falconAngles_rad(reply.encoders), position_m_);
  if (!position_m) return false;
  const double out_mm = 1e3 * (*position_m - kFalconCentre_m).norm();
  if (!(out_mm <= kFarthest_mm)) return false;
  // After a silence the force ramps in like the first time.
  if (since > kSilent) ramp_begin_ = at;
  if (phase_ == Phase::kOutside && out_mm <= kMiddle_mm) {
    phase_ = Phase::kReady;
    was_ready_ = true;
    ramp_begin_ = at;
  }
  rejected_ = 0;
  last_ = reply;
  accepted_ = at;
  position_m_ = *position_m;
  fresh_ = true;
  return true;
}

/// Counts an implausible reply. A flipped bit ends with the next reply; a lasting shift means that
/// the counters have lost the position.
void FalconPilot::rejectPosition() noexcept {
  ++implausible_;
  if (++rejected_ < kMostDoubts) return;
  rejected_ = 0;
  forget_ = kHomedReplies;
  must_forget_ = true;
  phase_ = Phase::kHoming;
  homed_replies_ = 0;
}

void FalconPilot::onLost() noexcept {
  phase_ = Phase::kAway;
  homed_replies_ = 0;
  rejected_ = 0;
  forget_ = 0;
  must_forget_ = false;
  fresh_ = false;
}

DeviceState FalconPilot::state() noexcept {
  DeviceState state;
  state.position_mm = 1e3 * (position_m_ - kFalconCentre_m);
  state.buttons = buttons_;
  state.time = accepted_;
  const bool fresh = std::exchange(fresh_, false);
  if (phase_ == Phase::kReady) {
    state.status = fresh ? DeviceStatus::kOk : DeviceStatus::kNoData;
  } else {
    state.status = was_ready_ ? DeviceStatus::kLost : DeviceStatus::kNoData;
  }
  return state;
}

std::uint8_t FalconPilot::computeLights(LocalTime now) const noexcept {
  const bool flash = now.time_since_epoch() / kBlink % 2 == 0;
  if (warns_ && phase_ == Phase::kReady) return flash ? FalconLight::kRed : 0;
  if (phase_ == Phase::kReady) return FalconLight::kGreen;
  return phase_ == Phase::kOutside ? FalconLight::kBlue : FalconLight::kRed;
}

FalconRequest FalconPilot::request(const Vec3& force_N, LocalTime now) noexcept {
  FalconRequest request;
  request.lights = computeLights(now);
  if (forget_ > 0) {
    --forget_;
    request.homing = false;
    return request;
  }
  if (phase_ != Phase::kReady || now - accepted_ > kSilent) return request;
  const double ramp = std::clamp(toSeconds(now - ramp_begin_) / toSeconds(kRamp), 0.0, 1.0);
  const auto torques = falconTorques(position_m_, ramp * force_N);
  if (!torques) return request;
  request.motors = falconMotors(*torques, gain_, kMostMotor);
  if (gain_ * torques->cwiseAbs().maxCoeff() > kMostMotor) ++saturated_;
  return request;
}

}  // namespace hapticast::client
