// SPDX-License-Identifier: MIT
// Extreme cases in front of a plane wall: the chain and the naive loop.
#include <algorithm>
#include <cmath>
#include <limits>

#include "client/device/profile/device_profile.hpp"
#include "tests/evaluate/stability/stability_cases.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct Plane {
  std::string name;
  double target_mm;  ///< where the hand wants to be before: -5: 2 mm deep, 5: above
  std::function<void(ChainFixture&, int)> event;
  std::function<Duration(int)> period = [](int) { return Duration(1'000'000); };
  double stiffness_N_mm = 1.0;
  const char* device = "omni";
};

CaseOutcome happens(const Plane& what, bool naive) {
  PlantProfile profile = loadDeviceProfile(what.device);
  profile.stiffness_N_mm = what.stiffness_N_mm;
  ChainFixture rig(profile, profile, Hand::light());
  rig.by_counts = naive;
  if (naive) rig.law = bareLaw(0.0, profile.peak_N);
  rig.device.reset({0.0, 0.0, 10.0}, Vec3::Zero());
  rig.run(300);
  for (int i = 0; i < 1600; ++i) {
    const double s = std::min(1.0, i / 300.0);
    rig.device.setTarget({0.0, 0.0, 10.0 + (what.target_mm - 10.0) * s});
    rig.step();
  }
  rig.clear();
  CaseOutcome out;
  const double before_mJ = rig.true_work_mJ;
  for (int i = 0; i < 1500; ++i) {
    what.event(rig, i);
    rig.step(what.period(i));
    out.speed_mm_s = std::max(out.speed_mm_s, rig.device.trueVelocity_mm_s().z());
    out.energy_mJ = std::max(out.energy_mJ, rig.true_work_mJ - before_mJ);
    out.safety_actions |= rig.out.safety_actions;
    out.trace_N.push_back(rig.out.force_N.norm());
    out.trace_mm_s.push_back(rig.device.trueVelocity_mm_s().z());
  }
  out.peak_N = rig.max_force_N;
  out.step_N = rig.max_step_N;
  out.excess_N = rig.max_excess_N;
  out.end_N = rig.out.force_N.norm();
  out.finite = rig.finite;
  return out;
}

void moveWall(ChainFixture& rig, int i, int ticks, double speed_mm_s) {
  rig.wall_velocity_mm_s = i < ticks ? speed_mm_s : 0.0;
  if (i < ticks) rig.wall_mm += speed_mm_s * 1e-3;
}

std::function<Duration(int)> late(int ms) {
  return [ms](int i) { return Duration(1'000'000) * (i == 10 ? ms : 1); };
}

std::vector<Plane> surfaces() {
  return {
      {"surface appears 30 mm above the tip", 5.0,
       [](ChainFixture& rig, int i) {
         if (i == 0) rig.wall_mm = 35.0;
       }},
      {"30 mm rise within one frame of 40 ms", -5.0,
       [](ChainFixture& rig, int i) { moveWall(rig, i, 40, 750.0); }},
      {"the same, Falcon", -5.0, [](ChainFixture& rig, int i) { moveWall(rig, i, 40, 750.0); },
       late(1), 1.0, "falcon"},
      {"object arrives at 0.9 m/s", 5.0,
       [](ChainFixture& rig, int i) {
         if (i == 0) rig.wall_mm = -20.0;
         moveWall(rig, i, 33, 900.0);
       }},
      {"stall of 0.5 s, then +20 mm", -5.0,
       [](ChainFixture& rig, int i) {
         rig.touchable = i >= 500;
         if (i == 500) rig.wall_mm += 20.0;
       }},
      {"clock jump: surface +15 mm", -5.0,
       [](ChainFixture& rig, int i) {
         if (i == 0) rig.wall_mm += 15.0;
       }},
      {"clock jump: surface -15 mm", -5.0,
       [](ChainFixture& rig, int i) {
         if (i == 0) rig.wall_mm -= 15.0;
       }},
      {"NaN heights for 5 ticks", -5.0, [](ChainFixture& rig, int i) { rig.nan_heights = i < 5; }},
      {"an epoch every 20 ms", -5.0,
       [](ChainFixture& rig, int i) { rig.epoch_jump = i % 20 == 0; }},
  };
}

std::vector<Plane> forces() {
  const auto pulse = [](ChainFixture& rig, int i) {
    rig.dynamic_N.z() = i < 15 ? 3.0 * std::sin(M_PI * (i + 0.5) / 15.0) : 0.0;
  };
  return {
      {"impact 3 N, 15 ms, light press", -5.0, pulse},
      {"the same while saturated", -30.0, pulse},
      {"K = 0", -5.0, [](ChainFixture& rig, int) { rig.stiffness_N_mm = 0.0; }},
      {"K = 20 N/mm", -2.0, [](ChainFixture&, int) {}, late(1), 20.0},
      {"K denormal, then 1e300", -5.0,
       [](ChainFixture& rig, int i) { rig.stiffness_N_mm = i / 200 % 2 == 0 ? 5e-324 : 1e300; }},
      {"K NaN for 0.2 s", -5.0,
       [](ChainFixture& rig, int i) {
         rig.stiffness_N_mm = i < 200 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
       }},
      {"author's damping 1e300", -5.0, [](ChainFixture& rig, int) { rig.damping_Ns_m = 1e300; }},
  };
}

std::vector<Plane> hands() {
  return {
      {"tip at 2 m/s into the wall", 20.0,
       [](ChainFixture& rig, int i) {
         if (i == 0) rig.device.reset({0.0, 0.0, 15.0}, {0.0, 0.0, -2000.0});
         rig.device.setTarget({0.0, 0.0, -5.0});
       }},
      {"NaN positions for 5 ticks", -5.0, [](ChainFixture& rig, int i) { rig.blind = i < 5; }},
      {"late tick of 10 ms", -5.0, [](ChainFixture&, int) {}, late(10)},
      {"late tick of 200 ms", -5.0, [](ChainFixture&, int) {}, late(200)},
      {"late tick of 200 ms, surface at 50 mm/s", -5.0,
       [](ChainFixture& rig, int i) { moveWall(rig, i, 300, 50.0); }, late(200)},
      {"device lost", -5.0, [](ChainFixture& rig, int i) { rig.lost = i >= 10; }},
  };
}

std::vector<Plane> allPlanes() {
  std::vector<Plane> all = surfaces();
  for (const Plane& more : forces()) all.push_back(more);
  for (const Plane& more : hands()) all.push_back(more);
  return all;
}

/// Limits of a case's largest force and of the force at its end.
struct ForceLimits {
  const char* name;
  double least_peak_N = 0.0;
  double most_peak_N = 3.3;
  double least_end_N = 0.0;
  double most_end_N = 3.3;
};
constexpr ForceLimits kForceLimits[] = {
    {.name = "surface appears 30 mm above the tip", .most_peak_N = 0.0},
    {.name = "30 mm rise within one frame of 40 ms", .least_peak_N = 1.0},
    {.name = "object arrives at 0.9 m/s", .least_peak_N = 0.5},
    {.name = "stall of 0.5 s, then +20 mm", .most_end_N = 0.0},  // too deep: unarmed
    {.name = "clock jump: surface +15 mm"},
    {.name = "clock jump: surface -15 mm"},
    {.name = "NaN heights for 5 ticks", .least_end_N = 0.5},
    {.name = "impact 3 N, 15 ms, light press", .least_peak_N = 2.0},
    // The tank pays for no more on the way out.
    {.name = "tip at 2 m/s into the wall", .least_peak_N = 1.5},
    {.name = "NaN positions for 5 ticks"},
    {.name = "late tick of 10 ms"},
    {.name = "late tick of 200 ms"},
    {.name = "device lost", .most_end_N = 0.0},
};

bool keeps(const CaseOutcome& o, const ForceLimits& limits) {
  constexpr double kRounding_N = 1e-9;
  return o.finite && o.excess_N == 0.0 && o.peak_N >= limits.least_peak_N &&
         o.peak_N <= limits.most_peak_N + kRounding_N && o.end_N >= limits.least_end_N &&
         o.end_N <= limits.most_end_N + kRounding_N;
}

}  // namespace

std::vector<std::string> findUnexpectedForces() {
  std::vector<std::string> unexpected;
  const std::vector<Plane> all = allPlanes();
  for (const ForceLimits& limits : kForceLimits) {
    Plane plane = *std::find_if(all.begin(), all.end(),
                                [&](const Plane& each) { return each.name == limits.name; });
    for (const double stiffness_N_mm : {0.5, 1.0, 5.0}) {
      plane.stiffness_N_mm = stiffness_N_mm;
      if (!keeps(happens(plane, false), limits))
        unexpected.push_back(text("%s, K %g", limits.name, stiffness_N_mm));
    }
  }
  return unexpected;
}

std::vector<ExtremeCase> planeCases() {
  const std::vector<Plane> all = allPlanes();
  std::vector<ExtremeCase> cases(all.size());
  onAllCores(all.size(), [&](std::size_t i) {
    cases[i] = {all[i].name, loadDeviceProfile(all[i].device).peak_N, happens(all[i], true),
                happens(all[i], false)};
  });
  return cases;
}

}  // namespace hapticast::evaluate
