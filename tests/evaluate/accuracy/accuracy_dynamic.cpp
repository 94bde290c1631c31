// SPDX-License-Identifier: MIT
// Eq. 6: the object's inertia against m a of the truth, impacts against m dv, and the cursor's own
// term from positions in counts.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/device/profile/device_profile.hpp"
#include "client/haptics/dynamic_force.hpp"
#include "client/haptics/estimation/hip_estimator.hpp"
#include "common/time.hpp"
#include "tests/evaluate/accuracy/accuracy_parts.hpp"
#include "tests/evaluate/thread_time.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kFrame_s = 0.04;

bool near(const std::vector<double>& times_s, double time_s, double reach_s) {
  return std::any_of(times_s.begin(), times_s.end(),
                     [&](double t) { return std::abs(t - time_s) <= reach_s; });
}

struct DynamicTick {
  double time_s = 0.0;
  Vec3 force_N = Vec3::Zero();
  Vec3 truth_N = Vec3::Zero();    ///< m a
  Vec3 literal_N = Vec3::Zero();  ///< Eq. 5 as printed: a is the flow's velocity over one tick
};

// The dynamic force of a hand that lies 1 mm deep on the object.
std::vector<DynamicTick> dynamicForce(const TouchScene& scene, const Stream& stream,
                                      const Variant& variant, const client::DeviceProfile& profile,
                                      double& mass_kg) {
  client::DynamicForce dynamic(profile);
  std::vector<DynamicTick> out;
  const Hand hand = [&](double t) { return HandPoint{scene.motion(t).position_mm, Vec3::Zero()}; };
  renderTrace(
      stream, variant, hand, {},
      [&](const client::Scene& now, const client::StreamTiming& stream, const client::Contact&,
          const Tick& tick) {
        if (now.object_count == 0) return;
        mass_kg = dynamic.objectMass_kg({}, stream, 1.0);
        const client::InterpolatedObject& object = now.objects[0];
        const double kg_m = 1e-3 * mass_kg;
        out.push_back({tick.time_s,
                       dynamic.evaluate(&object, 1.0, Vec3::Zero(), now.play_time, stream, 1.0),
                       kg_m * scene.motion(tick.time_s).acceleration_mm_s2,
                       kg_m * object.velocity_mm_s / kTick_s});
      });
  return out;
}

double relative(const std::vector<DynamicTick>& ticks, const std::vector<double>& impacts_s,
                Vec3 DynamicTick::*what) {
  double error = 0;
  double truth = 0;
  for (const DynamicTick& tick : ticks) {
    if (near(impacts_s, tick.time_s, kFrame_s)) continue;
    error += (tick.*what - tick.truth_N).squaredNorm();
    truth += tick.truth_N.squaredNorm();
  }
  return truth > 0 ? 100.0 * std::sqrt(error / truth) : 0.0;
}

Outcome measureInertia(const TouchScene& scene, const std::vector<double>& impacts_s) {
  Outcome out;
  Goal goal{"dynamic force, " + scene.name + ": against m a", "%", 8.0, 3.0};
  for (const Variant& variant : {defaultVariant(), thesisVariant()}) {
    StreamKind kind;
    kind.method = variant.method;
    kind.scan = true;
    double mass_kg = 0;
    const auto ticks = dynamicForce(scene, makeStream(scene, kind), variant,
                                    client::loadDeviceProfile("omni"), mass_kg);
    const double error = relative(ticks, impacts_s, &DynamicTick::force_N);
    Variant named = variant;
    named.name = variant.is_thesis ? "thesis, change of velocity" : "rgbd, 7 frames";
    out.rows.push_back(rowOf(scene.name, "dynamic force", named, error, "%", 0.0));
    if (variant.is_default) goal.got = error;
    if (!variant.is_thesis) continue;
    named.name = "thesis, Eq. 5 as printed";
    goal.thesis = relative(ticks, impacts_s, &DynamicTick::literal_N);
    out.rows.push_back(rowOf(scene.name, "dynamic force", named, goal.thesis, "%", 0.0));
  }
  out.goals.push_back(goal);
  return out;
}

// Bounces whose pulse stays below the device's limit (three quarters of a Falcon's): by the
// lightest object there is, hardly faster than what is taken for an impact.
Outcome measureImpulse() {
  constexpr double kGravity_mm_s2 = 80.0, kFlight_s = 0.8, kFirst_s = 0.71;
  Outcome out;
  const TouchScene scene = bouncingBall(kGravity_mm_s2, kFlight_s, kFirst_s);
  const Vec3 jump_mm_s(0.0, kGravity_mm_s2 * kFlight_s, 0.0);
  StreamKind kind;
  kind.mass_kg = 0.45;
  double mass_kg = 0;
  const auto ticks = dynamicForce(scene, makeStream(scene, kind), defaultVariant(),
                                  client::loadDeviceProfile("falcon"), mass_kg);
  double worst = 0;
  for (const double impact_s : impactsOf(kFlight_s, kFirst_s, scene.duration_s - 0.3)) {
    Vec3 impulse_Ns = Vec3::Zero();
    for (const DynamicTick& tick : ticks) {
      // The pulse lasts 15 ms and may begin a little off; m a goes on meanwhile.
      if (std::abs(tick.time_s - impact_s) < kFrame_s)
        impulse_Ns += (tick.force_N - tick.truth_N) * kTick_s;
    }
    const Vec3 truth_Ns = 1e-3 * mass_kg * jump_mm_s;
    worst = std::max(worst, (impulse_Ns - truth_Ns).norm() / truth_Ns.norm());
  }
  out.rows.push_back(
      rowOf(scene.name, "impulse of a bounce, worst", defaultVariant(), 100.0 * worst, "%", 0.0));
  out.goals.push_back({"impulse of a bounce within the pulse limit: against m dv", "%", 10.0, 3.0,
                       100.0 * worst, 100.0});
  return out;
}

// --- the cursor's own term
// ------------------------------------------------------------------------

struct Cursor {
  std::string name;
  std::function<Vec3(const client::DeviceState&)> acceleration_m_s2;
};

std::vector<Cursor> cursors(const client::DeviceProfile& profile) {
  const auto motion = std::make_shared<client::HipEstimator>(profile);
  const auto last = std::make_shared<std::array<Vec3, 2>>();
  const auto known = std::make_shared<int>(0);
  return {
      {"2 x 20 Hz",
       [=](const client::DeviceState& state) { return motion->update(state).acceleration_m_s2; }},
      {"differences, Eq. 13-14", [=](const client::DeviceState& state) {
         const Vec3 twice = state.position_mm - 2.0 * (*last)[0] + (*last)[1];
         (*last)[1] = (*last)[0];
         (*last)[0] = state.position_mm;
         return *known < 2 ? (++*known, Vec3::Zero().eval())
                           : Vec3(1e-3 * twice / (kTick_s * kTick_s));
       }}};
}

// Rms error of -m a over 8 s after the first one, N.
double cursorError_N(const Cursor& cursor, double count_mm,
                     const std::function<std::pair<double, double>(double)>& path,
                     double& tick_us) {
  std::vector<client::DeviceState> states;
  std::vector<double> truth_m_s2;
  for (int i = 0; i < 9000; ++i) {
    const auto [x_mm, a_mm_s2] = path(1e-3 * i);
    client::DeviceState state;
    state.position_mm.x() = std::round(x_mm / count_mm) * count_mm;
    state.time = localTime(1e-3 * i);
    states.push_back(state);
    truth_m_s2.push_back(1e-3 * a_mm_s2);
  }
  double square = 0;
  const double start_us = threadTime_us();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double off = cursor.acceleration_m_s2(states[i]).x() - truth_m_s2[i];
    if (i >= 1000) square += off * off;
  }
  tick_us = (threadTime_us() - start_us) / double(states.size());
  return client::kCursorMass_kg * std::sqrt(square / double(states.size() - 1000));
}

Outcome measureCursor() {
  const client::PlantProfile profile = client::loadDeviceProfile("omni");
  const double count_mm = profile.count_mm;
  // A hand that rests trembles, at some 9 Hz by some hundredths of a millimetre, and drifts.
  const auto rest = [](double t) {
    const double w = 2.0 * std::numbers::pi * 9.0;
    const double drift = 2.0 * std::numbers::pi * 0.13;
    return std::pair{0.02 * std::sin(w * t) + 0.3 * std::sin(drift * t), 0.0};
  };
  const auto wave = [](double t) {
    const double w = 2.0 * std::numbers::pi * 2.0;
    return std::pair{30.0 * std::sin(w * t), -30.0 * w * w * std::sin(w * t)};
  };
  Outcome out;
  Goal noise{"inertia term at rest: noise", "N rms", 0.015, 0.01};
  Goal error{"inertia term at 2 Hz, 30 mm: error", "N rms", 0.04, 0.03};
  for (const bool at_rest : {true, false}) {
    for (const Cursor& cursor : cursors(profile)) {
      const bool ours = cursor.name == "2 x 20 Hz";
      double tick_us = 0;
      const double got = at_rest ? cursorError_N(cursor, count_mm, rest, tick_us)
                                 : cursorError_N(cursor, count_mm, wave, tick_us);
      out.rows.push_back({at_rest ? "at rest" : "2 Hz, 30 mm", "inertia of the cursor", cursor.name,
                          got, "N rms", tick_us, ours, !ours});
      Goal& goal = at_rest ? noise : error;
      (ours ? goal.got : goal.thesis) = got;
    }
  }
  out.goals = {noise, error};
  return out;
}

std::vector<double> syntheticImpacts(server::SceneKind kind) {
  const server::SyntheticScene scene(kind);
  std::vector<double> out;
  for (const server::SceneImpact& impact : scene.impacts()) out.push_back(impact.time_s);
  return out;
}

}  // namespace

std::vector<Case> dynamicCases(bool quick) {
  std::vector<Case> out;
  out.emplace_back(measureCursor);
  std::vector<server::SceneKind> kinds{server::SceneKind::kBounce};
  if (!quick) kinds.push_back(server::SceneKind::kTumble);
  for (const server::SceneKind kind : kinds)
    out.emplace_back([=] { return measureInertia(syntheticScene(kind), syntheticImpacts(kind)); });
  if (!quick) out.emplace_back(measureImpulse);
  return out;
}

}  // namespace hapticast::evaluate
