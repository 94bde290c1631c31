// SPDX-License-Identifier: MIT
#include "tests/evaluate/figures/figures_moments.hpp"

#include <cmath>

#include "client/device/device_profile.hpp"
#include "client/haptics/dynamic_force.hpp"
#include "client/haptics/estimation/hip_estimator.hpp"
#include "tests/evaluate/accuracy/accuracy_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr const char* kStaticColor = "#2a78d6";
constexpr const char* kTotalColor = "#d1495b";
constexpr double kCount_mm = 0.055;  // the device's

Curve curveOf(const std::vector<Moment>& moments, Vec3 Moment::*what, int axis, std::string name,
              std::string color, double width, bool dashed = false) {
  Curve out{std::move(name), std::move(color), {}, width, dashed, false};
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
  feel(stream, variant, hand, {},
       [&](const client::Scene& scene, const client::StreamTiming& stream,
           const client::Contact& contact, const Tick& tick) {
         client::DeviceState device;
         device.position_mm = kCount_mm * (tick.hand.hip_mm / kCount_mm).array().round().matrix();
         device.time = localTime(tick.time_s);
         const client::HipEstimate& hip = motion.update(device);
         Moment now;
         now.time_s = tick.time_s;
         now.static_N = kStiffness_N_mm * tick.displacement_mm;
         now.true_static_N = kStiffness_N_mm * tick.hand.truth_mm;
         now.total_N = now.static_N;
         now.true_total_N = now.true_static_N;
         if (tick.contact) {
           now.total_N +=
               dynamic.evaluate(contact.object, tick.displacement_mm.norm(), hip.acceleration_m_s2,
                                scene.play_time, stream, 1.0, &tick.hand.hip_mm);
         }
         if (tick.trulyTouches() && body) {
           now.true_total_N +=
               1e-3 * dynamic.objectMass_kg(stream, 1.0) * body(tick.time_s).acceleration_mm_s2 -
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

CurvePanel forcePanel(const std::vector<Moment>& moments, int axis, const std::string& title,
                      bool with_truth) {
  CurvePanel panel;
  panel.title = title;
  panel.x_label = "time, s";
  panel.y_label = std::string("force in ") + "xyz"[axis] + ", N";
  if (with_truth) {
    panel.curves.push_back(
        curveOf(moments, &Moment::true_static_N, axis, "static, truth", "#b8c8dc", 4.0));
    panel.curves.push_back(
        curveOf(moments, &Moment::true_total_N, axis, "total, truth", "#e6bcc2", 4.0));
  }
  panel.curves.push_back(curveOf(moments, &Moment::static_N, axis, "static", kStaticColor, 1.5));
  panel.curves.push_back(curveOf(moments, &Moment::total_N, axis, "total", kTotalColor, 1.5));
  return panel;
}

}  // namespace hapticast::evaluate
