// SPDX-License-Identifier: MIT
// Depth with the errors of an estimator: what vision makes of it, against exact depth.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "server/vision/vision.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"
#include "tests/scenes/estimator.hpp"

namespace hapticast::evaluate {

namespace {

using server::EstimatedDepth;

constexpr double kTip_mm = 15.0;  // the tip stays at half of the relief
constexpr double kMass_kg = 0.1;
// ball_air is before a wall, whose single depth does not show the scale: it is no part of the goal.
constexpr std::array<std::string_view, 4> kScenes{"still", "box_table", "creature", "ball_air"};

// The author states the depths between which a relative estimator works.
Clip estimate(const Clip& exact, server::test::Estimator estimator) {
  Clip out = exact;
  double near_mm = 0.0;
  double far_mm = 0.0;
  cv::minMaxLoc(exact.frames.front().depth, &near_mm, &far_mm);
  estimator.range = {near_mm, far_mm};
  out.frames = server::test::estimateFrames(exact.frames, estimator);
  out.info.estimated = estimator.kind;
  out.info.depth_range.reset();
  return out;
}

// Static force of a tip that visits each pixel at kTip_mm, against exact heights: rms of the
// difference over the rms of the truth, from the frame `from` on.
double forceError(const Reliefs& got, const Reliefs& exact, std::size_t from) {
  const auto push = [](float height_mm) {
    return std::isnan(height_mm) ? 0.0
                                 : kStiffness_N_mm * std::max(0.0, double(height_mm) - kTip_mm);
  };
  double off = 0.0;
  double all = 1e-9;
  for (std::size_t i = from; i < got.height_mm.size(); ++i) {
    for (int v = 0; v < got.height_mm[i].rows; ++v) {
      for (int u = 0; u < got.height_mm[i].cols; ++u) {
        const double truth = push(exact.height_mm[i].at<float>(v, u));
        off += std::pow(push(got.height_mm[i].at<float>(v, u)) - truth, 2);
        all += truth * truth;
      }
    }
  }
  return std::sqrt(off / all);
}

struct MotionErrors {
  std::size_t impacts = 0;
  double dynamic_N = 0.0;  // largest force of the acceleration
};

// What Vision sends of the clip.
MotionErrors sendClip(const Clip& clip) {
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points = {{centroidOf_px(clip.truth[0].mask)}};
  server::test::FunctionSource source(clip.info, clip.frames.size(),
                                      [&](std::uint64_t i) { return clip.frames[i]; });
  server::Vision vision(clip.info, settings);
  vision.scan(source, nullptr);
  MotionErrors out;
  const auto add = [&out](const HapticFrame& frame) {
    for (const HapticObject& object : frame.objects) {
      out.impacts += object.impacts.size();
      out.dynamic_N =
          std::max(out.dynamic_N, 1e-3 * kMass_kg * object.motion.acceleration_mm_s2.norm());
    }
  };
  for (std::size_t i = 0; i < clip.frames.size(); ++i) {
    const auto frame = source.read();
    if (auto result = vision.push(*frame, mediaTime(1.0 + double(i) / clip.info.fps)))
      add(result->frame);
  }
  for (const server::VisionResult& result : vision.flush()) add(result.frame);
  return out;
}

// The worst of all scenes and kinds.
struct Worst {
  double force = 0.0;
  double rest_N = 0.0;
  std::size_t impacts = 0;
};

void measureEstimator(const Clip& exact, const Reliefs& truth, const char* name,
                      const server::test::Estimator& estimator, Worst& worst, Report& report) {
  const Clip clip = estimate(exact, estimator);
  const Reliefs got = reliefsOf(clip, server::SegmentMode::kBand, Method::kHapticast);
  const std::string scene = exact.scene + "/" + name;
  const auto row = [&](const char* stage, double error, const char* unit) {
    report.add({scene, stage, "hapticast", error, unit, got.time_us, true, false});
  };
  const double force = forceError(got, truth, 0);
  row("estimated: static force", force, "rms of the force");
  const MotionErrors motion = sendClip(clip);
  row("estimated: impacts", double(motion.impacts), "count");
  if (exact.scene != "ball_air") worst.force = std::max(worst.force, force);
  worst.impacts += motion.impacts;
  if (exact.scene != "still") return;
  const double mm_per_px = 160.0 / clip.info.width_px;
  const double first_N = forceNoise_N(got.height_mm, 0, kSettled, mm_per_px);
  const double rest_N = forceNoise_N(got.height_mm, kSettled, got.height_mm.size(), mm_per_px);
  row("estimated: rest", rest_N, "N rms");
  row("estimated: rest, first second", first_N, "N rms");
  row("estimated: rest, dynamic force", motion.dynamic_N, "N");
  worst.rest_N = std::max({worst.rest_N, rest_N, motion.dynamic_N});
}

}  // namespace

void measureEstimated(Report& report) {
  Worst worst;
  for (const TestScene& scene : segmentationScenes()) {
    if (std::find(kScenes.begin(), kScenes.end(), scene.name) == kScenes.end()) continue;
    const Clip exact = renderClips(scene, {{"exact", Sensor{}}}, {640, 480, 60}).front();
    const Reliefs truth = reliefsOf(exact, server::SegmentMode::kSource, Method::kHapticast);
    const Reliefs own = reliefsOf(exact, server::SegmentMode::kBand, Method::kHapticast);
    report.add({exact.scene + "/exact depth", "estimated: static force", "exact depth",
                forceError(own, truth, 0), "rms of the force", own.time_us, false, false});
    for (const std::uint64_t seed : {1, 2, 3}) {
      const std::string number = " " + std::to_string(seed);
      measureEstimator(exact, truth, ("metric" + number).c_str(),
                       {.kind = EstimatedDepth::kMetric, .seed = seed}, worst, report);
      measureEstimator(exact, truth, ("inverse" + number).c_str(),
                       {.kind = EstimatedDepth::kInverse, .seed = seed}, worst, report);
    }
  }
  report.add(Goal{"estimated depth: static force, worst scene", "rms of the force", 0.05, 0.02,
                  worst.force});
  report.add(Goal{"estimated depth: force noise at rest, worst", "N", 0.01, 0.003, worst.rest_N});
  report.add(Goal{"estimated depth: false impacts", "count", 0.0, 0.0, double(worst.impacts)});
}

}  // namespace hapticast::evaluate
