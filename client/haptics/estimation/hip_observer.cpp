// SPDX-License-Identifier: MIT
#include "client/haptics/estimation/hip_observer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
// All values measured with the presses of client/haptics/stability.md.
constexpr double kSlowest_rad_s = 15.0;
constexpr double kFastest_rad_s = 550.0;
constexpr double kSoft_rad_s = 50.0;            // pole at rest in a soft wall
constexpr double kStiff_rad_s_N_mm = 60.0;      // pole at rest, times the stiffness of the wall
constexpr double kQuietResidual_counts = 1.07;  // residuals up to a count are no news
constexpr double kQuietMean_counts = 0.19;
constexpr double kMean_s = 11e-3;
const double kCalms = std::exp(-kTick_s / 55e-3);
// Largest motion of the HIP, over as many ticks as its count was constant.
constexpr double kFastest_counts = 16.0;

const double kShareStep = 1.0 - std::exp(-200.0 * kTick_s);  // low- and high-passes of 200 rad/s
constexpr double kShareMargin = 1.15;  // an overstated mass costs more than an understated one
constexpr double kShareMemory_s = 0.3;
constexpr double kShareDoubt_N = 0.012;  // prior: a weaker force leaves the share at 1
constexpr double kLeastShare = 0.04;

/// Returns the mass of the model as a share of the device's mass. A long prediction with an
/// overstated mass lets a light device in a grip oscillate, on small shapes first.
double computeMassFactor(int delay_ticks) noexcept {
  constexpr std::array<double, kMostDelay_ticks + 1> kFactors = {1.03, 1.03, 0.9, 0.75, 0.75, 0.75};
  return kFactors[static_cast<std::size_t>(std::clamp(delay_ticks, 0, kMostDelay_ticks))];
}
}  // namespace

// The force passes two low-passes and two high-passes of one pole. The position passes four
// high-passes: two of them act as the two low-passes and the second difference of m x''.
EffectiveMassEstimator::EffectiveMassEstimator(double mass_kg) noexcept
    : newton_per_mm_(kShareMargin * mass_kg * 1e-3 *
                     std::pow(kShareStep / ((1.0 - kShareStep) * kTick_s), 2)) {}

void EffectiveMassEstimator::restart(const Vec3& measured_mm, const Vec3& acting_N) noexcept {
  slow_N_ << acting_N, acting_N, acting_N, Vec3::Zero();
  slow_mm_.setZero();
  slow_mm_.col(0) = measured_mm;
  last_N_ = Vec3::Zero();
}

void EffectiveMassEstimator::update(const Vec3& measured_mm, const Vec3& acting_N) noexcept {
  Vec3 fast_N = acting_N;
  Vec3 fast_mm = measured_mm;
  for (int i = 0; i < kFilters; ++i) {
    slow_N_.col(i) += kShareStep * (fast_N - slow_N_.col(i));
    fast_N = i < 2 ? Vec3(slow_N_.col(i)) : Vec3(fast_N - slow_N_.col(i));
    slow_mm_.col(i) += kShareStep * (fast_mm - slow_mm_.col(i));
    fast_mm -= slow_mm_.col(i);
  }
  const Vec3 mean_N = 0.5 * (fast_N + last_N_);  // zero-order hold: half a tick of delay
  last_N_ = fast_N;
  constexpr double kKeeps = 1.0 - kTick_s / kShareMemory_s;
  product_N2_ = kKeeps * product_N2_ + newton_per_mm_ * fast_mm.cwiseProduct(mean_N);
  square_N2_ = kKeeps * square_N2_ + mean_N.cwiseAbs2();
  constexpr double kDoubt_N2 = kShareDoubt_N * kShareDoubt_N * kShareMemory_s / kTick_s;
  share_ = (product_N2_.array() + kDoubt_N2) / (square_N2_.array() + kDoubt_N2);
  share_ = share_.cwiseMax(kLeastShare).cwiseMin(1.0);
}

HipObserver::HipObserver(const DeviceProfile& profile) noexcept
    : count_mm_(profile.count_mm),
      mm_s2_per_N_(1e3 / (computeMassFactor(profile.delay_ticks) * profile.mass_kg)),
      share_(computeMassFactor(profile.delay_ticks) * profile.mass_kg) {}

void HipObserver::restart(const HipState& tip, const Vec3& acting_N) noexcept {
  tip_ = tip;
  share_.restart(tip.position_mm, acting_N);
  hand_mm_s2_ = -mm_s2_per_N_ * share_.value().cwiseProduct(acting_N);
  mean_mm_ = rest_ticks_ = Vec3::Zero();
  last_mm_ = tip.position_mm;
  pole_rad_s_.setConstant(kFastest_rad_s);
}

void HipObserver::predict(HipState& tip, const Vec3& force_N) const noexcept {
  const Vec3 step_mm_s =
      kTick_s * (hand_mm_s2_ + mm_s2_per_N_ * share_.value().cwiseProduct(force_N));
  tip.position_mm += kTick_s * (tip.velocity_mm_s + 0.5 * step_mm_s);
  tip.velocity_mm_s += step_mm_s;
}

void HipObserver::update(const Vec3& measured_mm, const Vec3& acting_N, double wall_N_mm) noexcept {
  const Vec3 stands = (measured_mm.array() == last_mm_.array()).cast<double>();
  rest_ticks_ = stands.cwiseProduct(rest_ticks_ + Vec3::Ones());
  last_mm_ = measured_mm;
  const Vec3 before = share_.value();
  share_.update(measured_mm, acting_N);
  // The hand causes what the force no longer explains: a change of the share moves nothing.
  hand_mm_s2_ += mm_s2_per_N_ * (before - share_.value()).cwiseProduct(acting_N);
  predict(tip_, acting_N);
  const Vec3 residual_mm = measured_mm - tip_.position_mm;
  mean_mm_ += kTick_s / kMean_s * (residual_mm - mean_mm_);
  const double slowest_rad_s =
      std::clamp(kStiff_rad_s_N_mm / wall_N_mm, kSlowest_rad_s, kSoft_rad_s);
  for (int axis = 0; axis < 3; ++axis) correct(axis, residual_mm[axis], slowest_rad_s);
}

/// A variable pole: news opens the filter at once, and it closes slowly. So no movement sticks, and
/// rest is silent.
void HipObserver::correct(int axis, double residual_mm, double slowest_rad_s) noexcept {
  const double innovation = std::max(std::abs(residual_mm) / kQuietResidual_counts,
                                     std::abs(mean_mm_[axis]) / kQuietMean_counts) /
                            count_mm_;
  const double opened_rad_s =
      slowest_rad_s * std::max(1.0, innovation * innovation * innovation * innovation);
  const double calmed_rad_s = slowest_rad_s + (pole_rad_s_[axis] - slowest_rad_s) * kCalms;
  pole_rad_s_[axis] = std::max(std::min(opened_rad_s, kFastest_rad_s), calmed_rad_s);
  const double h = pole_rad_s_[axis] * kTick_s;
  const double z = 1.0 / (1.0 + h * (1.0 + h * (0.5 + h / 6.0)));  // exp(-h) within 0.3 %
  const double o = 1.0 - z;
  tip_.position_mm[axis] += (1.0 - z * z * z) * residual_mm;
  tip_.velocity_mm_s[axis] += 1.5 * o * o * (1.0 + z) / kTick_s * residual_mm;
  hand_mm_s2_[axis] += o * o * o / (kTick_s * kTick_s) * residual_mm;
}

HipState HipObserver::predictAhead(const SentForces& sent, int delay_ticks) const noexcept {
  HipState tip = tip_;
  for (int ticks = delay_ticks; ticks >= 1; --ticks) predict(tip, sent.ago(ticks));
  // A push without a motion (a nailed HIP, a very stiff hand) must not become a predicted motion.
  const Vec3 most_mm_s =
      (kFastest_counts * count_mm_ / kTick_s) * rest_ticks_.cwiseMax(1.0).cwiseInverse();
  tip.velocity_mm_s = tip.velocity_mm_s.cwiseMax(-most_mm_s).cwiseMin(most_mm_s);
  const Vec3 path_mm = (delay_ticks + kPredictionMargin_ticks) * kTick_s * most_mm_s;
  tip.position_mm += kPredictionMargin_ticks * kTick_s * tip.velocity_mm_s;
  tip.position_mm =
      tip.position_mm.cwiseMax(tip_.position_mm - path_mm).cwiseMin(tip_.position_mm + path_mm);
  return tip;
}

}  // namespace hapticast::client
