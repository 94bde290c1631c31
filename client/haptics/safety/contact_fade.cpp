// SPDX-License-Identifier: MIT
#include "client/haptics/safety/contact_fade.hpp"

#include <algorithm>
#include <cmath>

#include "client/haptics/safety/safety_action.hpp"

namespace hapticast::client {

namespace {
double smoothstep(double x) noexcept { return x * x * (3.0 - 2.0 * x); }

/// Returns the argument at which smoothstep() has the value `y` (0..1).
double inverseSmoothstep(double y) noexcept {
  return std::clamp(0.5 - std::sin(std::asin(1.0 - 2.0 * y) / 3.0), 0.0, 1.0);
}
}  // namespace

double ContactFade::gain() const noexcept { return smoothstep(fade_); }

void ContactFade::restart() noexcept {
  fade_ = 0.0;
  check_depth_ = true;
}

std::uint32_t ContactFade::step(const FadeTick& tick, DiscontinuityAccount& account) noexcept {
  std::uint32_t actions = 0;
  if (tick.jump) {
    onJump(tick, account);
    check_depth_ = true;
    actions |= bit(SafetyAction::kJump);
  } else if (tick.gap_mJ > 0.0 && tick.contact) {
    onGap(tick, account);
  }
  if (tick.touchable && check_depth_) {
    blocked_ = arms_ && tick.contact && tick.too_deep;
    check_depth_ = false;
  }
  if (tick.touchable && !tick.contact) blocked_ = false;
  advance(tick, tick.touchable && !blocked_, account);
  check_depth_ = check_depth_ || !tick.touchable;
  rampDown();
  stored_mJ_ = tick.contact ? gain() * tick.spring_mJ : 0.0;
  touched_ = tick.contact;
  if (residue_N_ != Vec3::Zero()) actions |= bit(SafetyAction::kResidue);
  if (tick.contact && blocked_) actions |= bit(SafetyAction::kDisarmed);
  if (tick.contact && fade_ < 1.0) actions |= bit(SafetyAction::kFade);
  return actions;
}

/// Begins the new wall with the gain that continues the old force, as far as the account pays.
void ContactFade::onJump(const FadeTick& tick, DiscontinuityAccount& account) noexcept {
  const double square_N2 = tick.full_N.squaredNorm();
  const bool continues = fades_ && tick.touchable && tick.contact && touched_ && square_N2 > 0.0;
  double gain = continues ? std::clamp(tick.last_N.dot(tick.full_N) / square_N2, 0.0, 1.0) : 0.0;
  if (continues && tick.spring_mJ > 0.0) {
    const double added_mJ = std::max(0.0, gain * tick.spring_mJ - stored_mJ_) + tick.gap_mJ;
    const double unpaid_mJ = added_mJ - account.pay(added_mJ);
    gain = std::max(0.0, gain - unpaid_mJ / tick.spring_mJ);
  }
  fade_ = inverseSmoothstep(gain);
  residue_N_ = fades_ ? Vec3(tick.last_N - gain * tick.full_N) : Vec3(Vec3::Zero());
  residue_static_N_ =
      fades_ ? Vec3(tick.last_static_N - gain * tick.full_static_N) : Vec3(Vec3::Zero());
}

/// Reduces the gain by the energy of the gap that the account cannot pay.
void ContactFade::onGap(const FadeTick& tick, DiscontinuityAccount& account) noexcept {
  const double gap_mJ = gain() * tick.gap_mJ;
  const double unpaid_mJ = gap_mJ - account.pay(gap_mJ);
  if (!fades_ || !(unpaid_mJ > 0.0) || !(tick.spring_mJ > 0.0)) return;
  fade_ = inverseSmoothstep(std::max(0.0, gain() - unpaid_mJ / tick.spring_mJ));
}

void ContactFade::advance(const FadeTick& tick, bool armed,
                          DiscontinuityAccount& account) noexcept {
  if (!fades_) {
    fade_ = armed ? 1.0 : 0.0;
    return;
  }
  const double wanted = std::clamp(fade_ + (armed ? kFadeIn : -kFadeOut), 0.0, 1.0);
  const double added_mJ =
      tick.contact ? (smoothstep(wanted) - smoothstep(fade_)) * tick.spring_mJ : 0.0;
  const double paid_mJ = account.pay(added_mJ);
  fade_ = paid_mJ < added_mJ ? inverseSmoothstep(gain() + paid_mJ / tick.spring_mJ) : wanted;
}

void ContactFade::rampDown() noexcept {
  const double residue_N = residue_N_.norm();
  const double left = residue_N > residue_step_N_ ? 1.0 - residue_step_N_ / residue_N : 0.0;
  residue_N_ *= left;
  residue_static_N_ *= left;
}

}  // namespace hapticast::client
