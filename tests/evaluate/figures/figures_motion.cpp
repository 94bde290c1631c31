// SPDX-License-Identifier: MIT
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "client/haptics/dynamic_force.hpp"
#include "tests/evaluate/figures/figures_moments.hpp"
#include "tests/evaluate/figures/figures_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kBall_mm = 15.0;
const Vec3 kBallAt(1.37, -0.81, 8.0);

TouchScene swingingBall(const Vec3& amplitude_mm, double hz) {
  const double turn = 2 * std::numbers::pi * hz;
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
    out.hip_mm =
        at_mm + std::sin(2 * std::numbers::pi * hz * t) * amplitude_mm + Vec3(0.0, 0.0, drop_mm);
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
      const double turn = 2 * std::numbers::pi * figure.hand_hz;
      const std::vector<Moment> moments = forcesOf(
          stream, variant, swingingHand(scene, at_mm, amplitude_mm, figure.hand_hz),
          [=](double t) { return Vec3(-1e-3 * turn * turn * std::sin(turn * t) * amplitude_mm); },
          scene.motion);
      const std::string cursor = accelerates ? "cursor accelerating" : "cursor still";
      std::string title = method + ", ";
      title += cursor;
      panels.push_back(forcePanel(moments, figure.axis, title, true));
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

}  // namespace hapticast::evaluate
