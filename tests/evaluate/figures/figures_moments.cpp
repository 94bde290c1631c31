// SPDX-License-Identifier: MIT
#include "tests/evaluate/figures/figures_moments.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "client/device/profile/device_profile.hpp"
#include "client/haptics/dynamic_force.hpp"
#include "client/haptics/estimation/hip_estimator.hpp"
#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kCount_mm = 0.055;  // the device's

Curve curveOf(const std::vector<Moment>& moments, Vec3 Moment::*what, int axis, std::string name,
              std::string color) {
  Curve out{std::move(name), std::move(color), {}, 1.5, false, false};
  for (const Moment& moment : moments) out.points.push_back({moment.time_s, (moment.*what)[axis]});
  return out;
}

}  // namespace

std::vector<Moment> forcesOf(const Stream& stream, const Variant& variant, const Hand& hand,
                             const HandAcceleration& hand_m_s2, const MotionAt& body) {
  static const client::PlantProfile profile = client::loadDeviceProfile("omni");
  client::DynamicForce dynamic(profile);
  client::HipEstimator motion(profile);
  std::vector<Moment> out;
  renderTrace(stream, variant, hand, {},
              [&](const client::Scene& scene, const client::StreamTiming& stream,
                  const client::Contact& contact, const Tick& tick) {
                client::DeviceState device;
                device.position_mm =
                    kCount_mm * (tick.hand.hip_mm / kCount_mm).array().round().matrix();
                device.time = localTime(tick.time_s);
                const client::HipEstimate& hip = motion.update(device);
                Moment now;
                now.time_s = tick.time_s;
                now.static_N = kStiffness_N_mm * tick.displacement_mm;
                now.true_static_N = kStiffness_N_mm * tick.hand.truth_mm;
                now.total_N = now.static_N;
                now.true_total_N = now.true_static_N;
                if (tick.contact) {
                  now.total_N += dynamic.evaluate(contact.object, tick.displacement_mm.norm(),
                                                  hip.acceleration_m_s2, scene.play_time, stream,
                                                  1.0, &tick.hand.hip_mm);
                }
                if (tick.trulyTouches() && body) {
                  now.true_total_N += 1e-3 * dynamic.objectMass_kg({}, stream, 1.0) *
                                          body(tick.time_s).acceleration_mm_s2 -
                                      client::kCursorMass_kg * hand_m_s2(tick.time_s);
                }
                out.push_back(now);
              });
  return out;
}

double errorOf(const std::vector<Moment>& moments, Vec3 Moment::*what, Vec3 Moment::*truth) {
  double error = 0;
  double all = 0;
  for (const Moment& moment : moments) {
    error += (moment.*what - moment.*truth).squaredNorm();
    all += (moment.*truth).squaredNorm();
  }
  return all > 0 ? 100.0 * std::sqrt(error / all) : 0.0;
}

CurvePanel slicePanel(const std::string& title, int axis, double radius_mm,
                      const std::vector<SliceArrows>& arrows) {
  constexpr double kMmPerN = 10.0;
  Curve surface{"surface", "#404040", {}, 2.0, false, false};
  for (int i = -90; i <= 90; ++i) {
    const double slope = i * std::numbers::pi / 180.0;
    surface.points.push_back({radius_mm * std::sin(slope), radius_mm * std::cos(slope)});
  }
  std::vector<Curve> curves{surface};
  for (const SliceArrows& each : arrows) {
    Curve curve{each.name, each.color, {}, each.width, false, true};
    for (const auto& [at_mm, force_N] : each.forces) {
      curve.points.push_back(
          {at_mm[axis], at_mm.z(), kMmPerN * force_N[axis], kMmPerN * force_N.z()});
    }
    curves.push_back(curve);
  }
  return {title,
          std::string(1, "xyz"[axis]) + ", mm",
          "z, mm; arrows: 1 N = 10 mm",
          curves,
          true,
          -1.8 * radius_mm,
          1.8 * radius_mm,
          -0.1 * radius_mm,
          1.7 * radius_mm};
}

CurvePanel forcePanel(const std::vector<Moment>& moments, int axis, const std::string& title) {
  CurvePanel panel;
  panel.title = title;
  panel.x_label = "time, s";
  panel.y_label = std::string("force in ") + "xyz"[axis] + ", N";
  panel.curves.push_back(curveOf(moments, &Moment::static_N, axis, "static", kStaticColor));
  panel.curves.push_back(curveOf(moments, &Moment::total_N, axis, "total", kTotalColor));
  return panel;
}

}  // namespace hapticast::evaluate
