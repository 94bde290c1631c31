// SPDX-License-Identifier: MIT
#include <algorithm>
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
constexpr double kDuration_s = 13.6;  // 25 periods of 0.5 s, and a little
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
  body.duration_s = kDuration_s;
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

// The hand visits one spot of the slice in each period of the ball. It is there at the ball's
// largest acceleration. Around that moment the hand has a constant acceleration.
constexpr int kSpots = 25;
constexpr double kSteepestSpot_rad = 60.0 * std::numbers::pi / 180.0;
constexpr double kDepth_mm = 1.5;
constexpr double kBall_hz = 2.0;
constexpr double kFirstVisit_s = 0.875;  // sin(turn t) = -1
constexpr double kVisit_s = 0.1;         // constant acceleration for so long before and after
constexpr double kLift_mm = 8.0;         // between two spots

double visitTime_s(int spot) { return kFirstVisit_s + spot / kBall_hz; }

Vec3 outwards(int spot) {
  const double slope = kSteepestSpot_rad * (2.0 * spot / (kSpots - 1) - 1.0);
  return {0.0, std::sin(slope), std::cos(slope)};
}

struct Visit {
  Vec3 at_mm, acceleration_mm_s2;
  [[nodiscard]] Vec3 position_mm(double since_s) const {
    return at_mm + 0.5 * since_s * since_s * acceleration_mm_s2;
  }
};

Visit visitOf(int spot, const MotionAt& ball, const Vec3& acceleration_mm_s2) {
  const Vec3 centre_mm = ball(visitTime_s(spot)).position_mm;
  return {centre_mm + (kBall_mm - kDepth_mm) * outwards(spot), acceleration_mm_s2};
}

// From one visit to the next one in a cubic, lifted off the ball.
Vec3 between_mm(const Visit& from, const Visit& to, const Vec3& outward, double s) {
  const double duration_s = 1.0 / kBall_hz - 2.0 * kVisit_s;
  const Vec3 tangent_mm =
      duration_s * kVisit_s * from.acceleration_mm_s2;  // leaves with a t, comes with -a t
  const Vec3 begin_mm = from.position_mm(kVisit_s);
  const Vec3 way_mm = to.position_mm(kVisit_s) - begin_mm;
  const double lift = std::sin(std::numbers::pi * s);
  return begin_mm + s * s * (3.0 - 2.0 * s) * way_mm + s * (1.0 - s) * tangent_mm +
         kLift_mm * lift * lift * outward;
}

Hand visitingHand(const MotionAt& ball, const Vec3& acceleration_mm_s2) {
  return [=](double t) {
    const int spot =
        std::clamp(static_cast<int>((t - kFirstVisit_s + kVisit_s) * kBall_hz), 0, kSpots - 1);
    const double since_s = t - visitTime_s(spot);
    const Visit visit = visitOf(spot, ball, acceleration_mm_s2);
    HandPoint out;
    out.hip_mm = visit.position_mm(since_s);
    if (since_s < -kVisit_s) {
      out.hip_mm = visit.position_mm(-kVisit_s) - 100.0 * (since_s + kVisit_s) * outwards(spot);
    } else if (since_s > kVisit_s && spot + 1 < kSpots) {
      out.hip_mm = between_mm(visit, visitOf(spot + 1, ball, acceleration_mm_s2), outwards(spot),
                              (since_s - kVisit_s) / (1.0 / kBall_hz - 2.0 * kVisit_s));
    }
    const Vec3 from = out.hip_mm - ball(t).position_mm;
    if (from.norm() < kBall_mm) out.truth_mm = (kBall_mm - from.norm()) * from.normalized();
    return out;
  };
}

struct MotionFigure {
  const char* file;
  const char* scene;
  Vec3 ball_mm;
  Vec3 hand_mm_s2;  ///< when it accelerates
};
const MotionFigure kMotionFigures[] = {{"figure_6.png", "across, ", {0, 5, 0}, {0, 600, 0}},
                                       {"figure_7.png", "towards, ", {0, 0, 2}, {0, 0, 300}}};

/// Returns the moments at the middle of each visit.
std::vector<Moment> visited(const std::vector<Moment>& moments) {
  std::vector<Moment> out;
  for (int spot = 0; spot < kSpots; ++spot) {
    const auto at = std::find_if(moments.begin(), moments.end(), [&](const Moment& moment) {
      return moment.time_s >= visitTime_s(spot);
    });
    if (at != moments.end()) out.push_back(*at);
  }
  return out;
}

CurvePanel profilePanel(const std::string& title, const std::vector<Moment>& moments) {
  std::vector<SliceArrows> arrows{{"static, truth", "#b8c8dc", 4.0, {}},
                                  {"total, truth", "#e6bcc2", 4.0, {}},
                                  {"static", kStaticColor, 1.5, {}},
                                  {"total", kTotalColor, 1.5, {}}};
  for (std::size_t spot = 0; spot < moments.size(); ++spot) {
    const Moment& moment = moments[spot];
    const Vec3 at_mm = (kBall_mm - kDepth_mm) * outwards(static_cast<int>(spot));
    arrows[0].forces.emplace_back(at_mm, moment.true_static_N);
    arrows[1].forces.emplace_back(at_mm, moment.true_total_N);
    arrows[2].forces.emplace_back(at_mm, moment.static_N);
    arrows[3].forces.emplace_back(at_mm, moment.total_N);
  }
  return slicePanel(title, 1, kBall_mm, arrows);
}

void drawMotion(const MotionFigure& figure, const Options& options, Report& report) {
  const TouchScene scene = swingingBall(figure.ball_mm, kBall_hz);
  std::vector<CurvePanel> panels;
  for (const Variant& variant : {thesisVariant(), defaultVariant()}) {
    StreamKind kind;
    kind.method = variant.method;
    kind.scan = true;
    const Stream stream = makeStream(scene, kind);
    const std::string method = variant.is_thesis ? "thesis" : "hapticast";
    for (const bool accelerates : {false, true}) {
      const Vec3 hand_mm_s2 = accelerates ? figure.hand_mm_s2 : Vec3(Vec3::Zero());
      const std::vector<Moment> moments = visited(forcesOf(
          stream, variant, visitingHand(scene.motion, hand_mm_s2),
          [=](double) { return Vec3(1e-3 * hand_mm_s2); }, scene.motion));
      const std::string cursor = accelerates ? "cursor accelerating" : "cursor still";
      std::string title = method + ", ";
      title += cursor;
      panels.push_back(profilePanel(title, moments));
      for (const auto& [stage, is, should] :
           {std::tuple{"static force", &Moment::static_N, &Moment::true_static_N},
            std::tuple{"total force", &Moment::total_N, &Moment::true_total_N}}) {
        report.add({figure.scene + cursor, stage, method, errorOf(moments, is, should), "%", 0.0,
                    variant.is_default, variant.is_thesis});
      }
    }
  }
  plotCurves(options.out / figure.file, panels, 2);
}

}  // namespace

void drawMotions(const Options& options, Report& report) {
  for (const MotionFigure& figure : kMotionFigures) drawMotion(figure, options, report);
}

}  // namespace hapticast::evaluate
