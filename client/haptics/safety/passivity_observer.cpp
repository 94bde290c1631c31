// SPDX-License-Identifier: MIT
#include "client/haptics/safety/passivity_observer.hpp"

#include <algorithm>
#include <cmath>

#include "client/haptics/safety/hand_limits.hpp"
#include "client/haptics/safety/wall_law.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
// All values measured or chosen with the battery of client/haptics/stability.md.
constexpr double kTolerated_mJ = 3.0;
// Limit of stored dissipation: a contact may not save up for long.
constexpr double kDebt_mJ = -2.0;
// Measured: --method thesis on a slope of 1.2 gives 1.6 mJ a beat. With 1 s it beats for ever.
constexpr double kForget_s = 10.0;
constexpr double kMostPassivityDamping_Ns_m = 5.0;
constexpr double kMostGrowth = 3.0;  // of that damping; with more, the force steps at single counts
constexpr double kSlowest_mm_s = 5.0;  // below, the counts decide the sign of the speed
constexpr double kSlow_ticks =
    4.5;  // a count; measured: 1.5 to 4.5 meter a shaken hand alike, within 3 %
constexpr double kTankSpeed_mm_s = 10.0;
constexpr double kTankHorizon_s = 0.02;
constexpr double kTankSmooth_s = 0.005;
constexpr double kReserve_s = 0.3;  // chosen: a rise of 30 mm under the hand ends within this time
}  // namespace

void SurfaceHistory::add(const Vec3& step_mm, int ticks_ahead) noexcept {
  newest_ = (newest_ + 1) % kKept;
  step_mm_.col(newest_) = step_mm;
  ticks_ahead_ = std::clamp(ticks_ahead, 0, kKept - 1);
}

Vec3 SurfaceHistory::coming_mm() const noexcept {
  Vec3 sum_mm = Vec3::Zero();
  for (int i = 0; i < ticks_ahead_; ++i) sum_mm += ago(i);
  return sum_mm;
}

void PassivityObserver::setDelay(int delay_ticks) noexcept {
  age_ = static_cast<std::size_t>(std::clamp(delay_ticks, 0, kMostDelay_ticks));
}

Vec3 PassivityObserver::computeWay(const PortTick& tick) noexcept {
  const Vec3 before_mm = at_mm_;
  const Vec3 leap_mm = tick.position_mm - counted_mm_;
  counted_mm_ = tick.position_mm;
  const auto goes_on = leap_mm.cwiseProduct(leap_mm_).array() > 0.0;
  const Vec3 moves = (!goes_on || ticks_.array() > kSlow_ticks).cast<double>();
  leap_mm_ = (leap_mm.array() != 0.0).select(leap_mm, leap_mm_);
  const Vec3 half_mm = half_count_mm_ * moves;
  at_mm_ =
      tick.connected
          ? Vec3(at_mm_.cwiseMax(tick.position_mm - half_mm).cwiseMin(tick.position_mm + half_mm))
          : tick.position_mm;
  return tick.connected ? Vec3(at_mm_ - before_mm) : Vec3(Vec3::Zero());
}

double PassivityObserver::meter(const PortTick& tick) noexcept {
  const Sent& acted = sent_[(newest_ + sent_.size() - age_) % sent_.size()];
  const Vec3 static_N = acted.force_N - acted.dynamic_N;
  static_sum_N_ += static_N;
  dynamic_sum_N_ += acted.dynamic_N;
  ticks_.array() += 1.0;
  const Vec3 path_mm = computeWay(tick);
  // By axis, without a branch: positions move by single counts.
  const Vec3 per_tick_mm = path_mm.cwiseQuotient(ticks_);
  const double static_mJ = per_tick_mm.dot(static_sum_N_);
  const double object_mJ = per_tick_mm.dot(dynamic_sum_N_);
  const Vec3 rests = (path_mm.array() == 0.0).cast<double>();
  static_sum_N_ = static_sum_N_.cwiseProduct(rests);
  dynamic_sum_N_ = dynamic_sum_N_.cwiseProduct(rests);
  ticks_ = ticks_.cwiseProduct(rests);
  const double surface_mJ = static_N.dot(tick.surface_mm);
  const double relative_mJ = static_mJ - surface_mJ;
  work_.relative_mJ += relative_mJ;
  work_.surface_mJ += surface_mJ;
  work_.object_mJ += object_mJ;

  generated_mJ_ = std::max(kDebt_mJ, generated_mJ_ * (1.0 - kTick_s / kForget_s) + relative_mJ +
                                         tick.stored_mJ - tick.stored_before_mJ);
  return static_mJ + object_mJ;
}

void PassivityObserver::sent(const Vec3& force_N, const Vec3& dynamic_N) noexcept {
  newest_ = (newest_ + 1) % sent_.size();
  sent_[newest_] = {force_N, dynamic_N};
}

double PassivityObserver::damping_Ns_m(double u_mm_s) const noexcept {
  const double excess_mJ = generated_mJ_ - kTolerated_mJ;
  if (!(excess_mJ > 0.0) || std::abs(u_mm_s) <= kSlowest_mm_s) return 0.0;
  const double most_Ns_m =
      kMostPassivityDamping_Ns_m * std::clamp(excess_mJ / kTolerated_mJ, 1.0, kMostGrowth);
  return std::min(most_Ns_m, 1e3 * excess_mJ / (kTick_s * u_mm_s * u_mm_s));
}

EnergyTank::EnergyTank(const DeviceProfile& profile) noexcept
    : most_mJ_(std::min(profile.tank_mJ, kHandEvent_mJ)),
      refill_W_(profile.tank_W),
      content_mJ_(most_mJ_),
      most_reserve_mJ_(std::min(kReserve_s * profile.tank_W * 1e3, kHandBurst_mJ)),
      reserve_mJ_(most_reserve_mJ_) {}

void EnergyTank::withdraw(double work_mJ, const Vec3& velocity_mm_s) noexcept {
  velocity_mm_s_ += kTick_s / kTankSmooth_s * (velocity_mm_s - velocity_mm_s_);
  const double refill_mJ = refill_W_ * kTick_s * 1e3;
  content_mJ_ = std::max(content_mJ_ - work_mJ, -most_mJ_);
  const double over_mJ = std::max(0.0, content_mJ_ - most_mJ_);
  const double lasting_mJ = std::min(refill_mJ, kHandPower_W * kTick_s * 1e3);
  reserve_mJ_ = std::min(reserve_mJ_ + over_mJ + lasting_mJ, most_reserve_mJ_);
  content_mJ_ -= over_mJ;
  const double poured_mJ = std::min({refill_mJ, reserve_mJ_, most_mJ_ - content_mJ_});
  reserve_mJ_ -= poured_mJ;
  content_mJ_ += poured_mJ;
}

double EnergyTank::factor(const Vec3& force_N) const noexcept {
  const double power = velocity_mm_s_.dot(force_N);  // mW
  const double drawn_mJ = power * kTankHorizon_s;
  if (!(drawn_mJ > content_mJ_)) return 1.0;
  return power / force_N.norm() > kTankSpeed_mm_s ? std::max(0.0, content_mJ_) / drawn_mJ : 1.0;
}

}  // namespace hapticast::client
