// SPDX-License-Identifier: MIT
#include <cmath>
#include <filesystem>
#include <numbers>

#include "client/device/device_profile.hpp"
#include "client/haptics/dynamic_force.hpp"
#include "client/haptics/hip_motion.hpp"
#include "server/source/rgbd_source.hpp"
#include "tests/evaluate/accuracy_parts.hpp"
#include "tests/evaluate/curves.hpp"
#include "tests/evaluate/figures_parts.hpp"
#include "tests/evaluate/touch_scenes.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr const char* kTruthColor = "#909090";
constexpr const char* kStaticColor = "#2a78d6";
constexpr const char* kTotalColor = "#d1495b";
constexpr double kCount_mm = 0.055;  // the device's

struct Moment {
  double time_s = 0.0;
  Vec3 static_N = Vec3::Zero(), total_N = Vec3::Zero();
  Vec3 true_static_N = Vec3::Zero(), true_total_N = Vec3::Zero();
};

/// Acceleration of the scripted hand, m/s².
using HandAcceleration = std::function<Vec3(double time_s)>;

// Static and total force of a hand whose positions come in counts.
std::vector<Moment> forcesOf(const Stream& stream, const Variant& variant, const Hand& hand,
                             const HandAcceleration& hand_m_s2, const MotionAt& body) {
  static const client::DeviceProfile profile = client::loadDeviceProfile("omni");
  client::DynamicForce dynamic(profile);
  client::HipMotion motion(profile.count_mm);
  std::vector<Moment> out;
  feel(stream, variant, hand, {},
       [&](const client::Scene& scene, const client::Controls& controls,
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
                                scene.play_time, controls, 1.0, &tick.hand.hip_mm);
         }
         if (tick.trulyTouches() && body) {
           now.true_total_N +=
               1e-3 * dynamic.objectMass_kg(controls, 1.0) * body(tick.time_s).acceleration_mm_s2 -
               client::kCursorMass_kg * hand_m_s2(tick.time_s);
         }
         out.push_back(now);
       });
  return out;
}

Curve curveOf(const std::vector<Moment>& moments, Vec3 Moment::*what, int axis, std::string name,
              std::string color, double width, bool dashed = false) {
  Curve out{std::move(name), std::move(color), {}, width, dashed, false};
  for (const Moment& moment : moments) out.points.push_back({moment.time_s, (moment.*what)[axis]});
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

// --- figure 5

constexpr double kRadius_mm = 20.0;
constexpr double kArrow_s = 0.16;  // each has so long
constexpr int kArrows = 25;
constexpr double kSteepest_rad = 75.0 * kPi / 180.0;

double slopeOf(int arrow) { return kSteepest_rad * (2.0 * arrow / (kArrows - 1) - 1.0); }

// From outside along the radius to 1 mm below the surface, at one angle after the other.
Hand slicingHand(const Vec3& centre_mm) {
  return [=](double time_s) {
    const int arrow = std::clamp(static_cast<int>((time_s - 0.4) / kArrow_s), 0, kArrows - 1);
    const double since_s = time_s - 0.4 - arrow * kArrow_s;
    const double depth_mm = std::min(1.0, -1.0 + since_s / (0.6 * kArrow_s) * 2.0);
    const double slope = slopeOf(arrow);
    const Vec3 outward(std::sin(slope), 0.0, std::cos(slope));
    HandPoint out;
    out.hip_mm = centre_mm + (kRadius_mm - depth_mm) * outward;
    if (depth_mm > 0) out.truth_mm = depth_mm * outward;
    return out;
  };
}

CurvePanel slicePanel(const Felt& felt, const Vec3& centre_mm, const std::string& title,
                      double& error) {
  Curve profile{"surface", "#404040", {}, 2.0, false, false};
  for (int i = -90; i <= 90; ++i) {
    const double slope = i * kPi / 180.0;
    profile.points.push_back({kRadius_mm * std::sin(slope), kRadius_mm * std::cos(slope)});
  }
  Curve truth{"truth", kTruthColor, {}, 3.0, false, true};
  Curve force{"static force, 1 N = 10 mm", kStaticColor, {}, 1.5, false, true};
  constexpr double kMmPerN = 10.0;
  std::vector<Moment> all;
  for (int arrow = 0; arrow < kArrows; ++arrow) {
    const double at_s = 0.4 + (arrow + 0.95) * kArrow_s;
    const auto tick = std::find_if(felt.ticks.begin(), felt.ticks.end(),
                                   [&](const Tick& t) { return t.time_s >= at_s; });
    if (tick == felt.ticks.end()) continue;
    const Vec3 from = tick->hand.hip_mm - centre_mm;
    const Vec3 is_N = kStiffness_N_mm * tick->displacement_mm;
    const Vec3 should_N = kStiffness_N_mm * tick->hand.truth_mm;
    truth.points.push_back({from.x(), from.z(), kMmPerN * should_N.x(), kMmPerN * should_N.z()});
    force.points.push_back({from.x(), from.z(), kMmPerN * is_N.x(), kMmPerN * is_N.z()});
    all.push_back({0.0, is_N, is_N, should_N, should_N});
  }
  error = errorOf(all, &Moment::static_N, &Moment::true_static_N);
  return {title, "x, mm", "z, mm", {profile, truth, force}, true, -36.0, 36.0, -2.0, 34.0};
}

}  // namespace

void drawSlice(const Options& options, Report& report) {
  const TouchScene scene = stillSphere();
  const Vec3 centre_mm = scene.motion(0.0).position_mm;
  const Hand hand = slicingHand(centre_mm);
  std::vector<CurvePanel> panels;
  for (const Variant& variant : allVariants()) {
    const bool wanted = variant.is_default || variant.is_thesis || variant.name == "normal" ||
                        variant.name == "perturbed, K 0";
    if (!wanted) continue;
    StreamKind kind;
    kind.method = variant.method;
    kind.longest_s = 0.4 + kArrows * kArrow_s + 0.3;
    double error = 0;
    const Felt felt = feel(makeStream(scene, kind), variant, hand);
    panels.push_back(slicePanel(felt, centre_mm, variant.name, error));
    report.add({"slice of the ball", "static force", variant.name, error, "%", 0.0,
                variant.is_default, variant.is_thesis});
  }
  plotCurves(options.out / "figure_5.png", panels, 2);
  report.say(
      "Figure 5: a slice of the ball (R 20 mm, 8-bit depth) with the static force of a tip 1 mm "
      "below the surface.");
  report.show("figure_5.png", "figure 5");
}

namespace {

// --- figures 6 and 7

constexpr double kBall_mm = 15.0;
const Vec3 kBallAt(1.37, -0.81, 8.0);

TouchScene swingingBall(const Vec3& amplitude_mm, double hz) {
  const double turn = 2 * kPi * hz;
  ReliefBody body;
  body.name = "ball";
  body.height_mm = [](const Vec2& q, double) {
    const double rest = kBall_mm * kBall_mm - q.squaredNorm();
    return rest > 0 ? std::sqrt(rest) : std::numeric_limits<double>::quiet_NaN();
  };
  body.reach_mm = kBall_mm + 1;
  body.duration_s = 3.0;
  body.motion = [=](double t) {
    Motion motion;
    motion.position_mm = kBallAt + std::sin(turn * t) * amplitude_mm;
    motion.velocity_mm_s = turn * std::cos(turn * t) * amplitude_mm;
    motion.acceleration_mm_s2 = -turn * turn * std::sin(turn * t) * amplitude_mm;
    motion.reference_point = ReferencePoint::kCentreOfMass;
    return motion;
  };
  return reliefScene(body);
}

// Swings about a place under the ball's top; what it should feel is radial.
Hand swingingHand(const TouchScene& scene, const Vec3& at_mm, const Vec3& amplitude_mm, double hz) {
  return [=, motion = scene.motion](double t) {
    // From above, so that it is in contact by its own way.
    const double drop_mm = 12.0 * std::max(0.0, 1.0 - t / 0.55);
    HandPoint out;
    out.hip_mm = at_mm + std::sin(2 * kPi * hz * t) * amplitude_mm + Vec3(0.0, 0.0, drop_mm);
    const Vec3 from = out.hip_mm - motion(t).position_mm;
    if (from.norm() < kBall_mm) out.truth_mm = (kBall_mm - from.norm()) * from.normalized();
    return out;
  };
}

struct MotionFigure {
  const char* file;
  const char* words;
  int axis;  ///< that is drawn
  Vec3 ball_mm;
  double ball_hz;
  double below_mm;  ///< the hand's middle, under the ball's top
  Vec3 hand_mm;     ///< when it accelerates
  double hand_hz;
};
const MotionFigure kMotionFigures[] = {
    {"figure_6.png", "Figure 6: the ball moves across", 0, {5, 0, 0}, 2.0, 1.5, {2.5, 0, 0}, 5.0},
    {"figure_7.png",
     "Figure 7: the ball moves towards the viewer",
     2,
     {0, 0, 2},
     2.0,
     2.6,
     {0, 0, 0.5},
     5.0}};

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

void drawMotion(const MotionFigure& figure, const Options& options, Report& report) {
  const TouchScene scene = swingingBall(figure.ball_mm, figure.ball_hz);
  std::vector<CurvePanel> panels;
  for (const Variant& variant : {thesisVariant(), defaultVariant()}) {
    StreamKind kind;
    kind.method = variant.method;
    kind.scan = true;
    const Stream stream = makeStream(scene, kind);
    const std::string method = variant.is_thesis ? "thesis" : "hapticast";
    for (const bool accelerates : {false, true}) {
      const Vec3 amplitude_mm = accelerates ? figure.hand_mm : Vec3(0, 0, 0);
      const Vec3 at_mm = kBallAt + Vec3(0, 0, kBall_mm - figure.below_mm);
      const double turn = 2 * kPi * figure.hand_hz;
      const std::vector<Moment> moments = forcesOf(
          stream, variant, swingingHand(scene, at_mm, amplitude_mm, figure.hand_hz),
          [=](double t) { return Vec3(-1e-3 * turn * turn * std::sin(turn * t) * amplitude_mm); },
          scene.motion);
      const std::string cursor = accelerates ? "cursor accelerating" : "cursor still";
      panels.push_back(forcePanel(moments, figure.axis, method + ", " + cursor, true));
      for (const auto& [stage, is, should] :
           {std::tuple{"static force", &Moment::static_N, &Moment::true_static_N},
            std::tuple{"total force", &Moment::total_N, &Moment::true_total_N}}) {
        report.add({std::string(figure.axis == 0 ? "across, " : "towards, ") + cursor, stage,
                    method, errorOf(moments, is, should), "%", 0.0, variant.is_default,
                    variant.is_thesis});
      }
    }
  }
  shareScale(panels);
  plotCurves(options.out / figure.file, panels, 2);
  report.say(std::string(figure.words) + "; left with the cursor still, right accelerating.");
  report.show(figure.file, figure.file);
}

}  // namespace

void drawMotions(const Options& options, Report& report) {
  for (const MotionFigure& figure : kMotionFigures) drawMotion(figure, options, report);
}

// --- figure 9

void drawRealClip(const Options& options, Report& report) {
  const std::filesystem::path clip = test::clipsFolder() / "visp_rbt_desk";
  if (!std::filesystem::exists(clip)) {
    report.say("Figure 9: left out, there is no " + clip.string() +
               " (HAPTICAST_CLIPS names the folder).");
    return;
  }
  std::map<std::string, Stream> streams;
  const std::vector<Variant> variants{thesisVariant(), defaultVariant()};
  for (const Variant& variant : variants) {
    const auto source = server::openSource(clip.string(), 0.0);
    server::VisionSettings settings;
    settings.method = variant.method;
    settings.object_points_px = {{505, 330}};
    settings.stretch = false;
    streams[variant.name] = makeStream(*source, settings, true);
  }
  // The tip stays on the dragon, 1 mm deep, where our stream says that its body is: one path for
  // both methods.
  std::map<std::int64_t, Vec3> path;
  const Stream& ours = streams[defaultVariant().name];
  feel(
      ours, defaultVariant(),
      [](double) {
        return HandPoint{{0, 0, 100}, Vec3::Zero()};
      },
      {},
      [&](const client::Scene& scene, const client::Controls& controls, const client::Contact&,
          const Tick& tick) {
        if (scene.object_count == 0) return;
        Vec3 at = scene.objects[0].position_mm;
        const auto under = client::surfaceAt(scene.objects[0], at.head<2>(), controls.workspace);
        at.z() =
            under.sample.height_mm - 1.0 + 12.0 * std::max(0.0, 1.0 - (tick.time_s - 0.4) / 0.2);
        path[std::llround(tick.time_s * 1e3)] = at;
      });
  const Hand hand = [&](double t) {
    const auto at = path.lower_bound(std::llround(t * 1e3));
    return HandPoint{at != path.end() ? at->second : Vec3(0, 0, 100), Vec3::Zero()};
  };
  std::vector<CurvePanel> panels;
  for (const Variant& variant : variants) {
    const std::vector<Moment> moments =
        forcesOf(streams[variant.name], variant, hand, nullptr, nullptr);
    const std::string method = variant.is_thesis ? "thesis" : "hapticast";
    for (const int axis : {0, 1}) panels.push_back(forcePanel(moments, axis, method, false));
  }
  shareScale(panels);
  plotCurves(options.out / "figure_9.png", panels, 2);
  report.say(
      "Figure 9: static and total force over time on a real clip (dragon of visp_rbt_desk): the "
      "tip "
      "stays 1 mm deep where the middle of the body is.");
  report.show("figure_9.png", "figure 9");
}

}  // namespace hapticast::evaluate
