// SPDX-License-Identifier: MIT
// The force of a baked clip beside that of the live server, both against exact truth.
#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "server/vision/base/masks.hpp"
#include "server/vision/offline/offline_vision.hpp"
#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/bake/bake_clips.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/evaluate/touch/touch_hands.hpp"
#include "tests/evaluate/touch/touch_player.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"
#include "tests/scenes/drawn_source.hpp"
#include "tests/scenes/relief_scenes.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kStiffness_N_mm = 0.5;
constexpr double kMass_kg = 0.5;
constexpr int kRim_px = 5;  // of the mask, in which no depth is measured well
constexpr double kNearImpact_s = 0.1;
constexpr double kMostWorse = 1.01;  // required: bake over live
constexpr double kNothing_N = 1e-4;  // an error below it has no ratio

/// Errors of one stream, N rms.
struct ForceError {
  double static_N = 0.0;   // of the heights
  double dynamic_N = 0.0;  // of the acceleration
  [[nodiscard]] double sum_N() const { return static_N + dynamic_N; }
};

class ErrorSums {
 public:
  ErrorSums(const BakeClip& clip, const server::DepthRange& range) : clip_(clip), range_(range) {}

  void add(const HapticFrame& frame) {
    const auto index =
        static_cast<std::size_t>(std::lround(toSeconds(frame.media_time) * clip_.info.fps));
    const BakeClip::Truth& truth = clip_.truth[index];
    const cv::Mat core = server::erodeBy(truth.mask, kRim_px);
    for (const HapticObject& object : frame.objects) addRelief(*object.relief, core, truth.depth);
    const bool bounces = std::any_of(clip_.impacts_s.begin(), clip_.impacts_s.end(), [&](double t) {
      return std::abs(t - toSeconds(frame.media_time)) < kNearImpact_s;
    });
    if (bounces || frame.objects.empty() || !truth.acceleration_mm_s2) return;
    dynamic_ +=
        (frame.objects[0].motion.acceleration_mm_s2 - *truth.acceleration_mm_s2).squaredNorm();
    ++frames_;
  }
  [[nodiscard]] ForceError errors() const {
    return {kStiffness_N_mm * std::sqrt(static_ / std::max(1.0, pixels_)),
            1e-3 * kMass_kg * std::sqrt(dynamic_ / std::max(1.0, frames_))};
  }

 private:
  void addRelief(const Relief& relief, const cv::Mat& core, const cv::Mat& depth) {
    const double gain = 30.0 / (range_.far_mm - range_.near_mm);
    std::size_t at = 0;
    for (int v = relief.rect.v; v < relief.rect.v + relief.rect.height; ++v) {
      for (int u = relief.rect.u; u < relief.rect.u + relief.rect.width; ++u, ++at) {
        if (relief.mask[at] == 0 || core.at<uchar>(v, u) == 0) continue;
        const double exact =
            std::clamp((range_.far_mm - double(depth.at<float>(v, u))) * gain, 0.0, 30.0);
        static_ += std::pow(double(relief.height_mm[at]) - exact, 2);
        pixels_ += 1;
      }
    }
  }

  const BakeClip& clip_;
  server::DepthRange range_;
  double static_ = 0, pixels_ = 0, dynamic_ = 0, frames_ = 0;
};

ForceError measureClip(const BakeClip& clip, bool offline) {
  server::test::FunctionSource source(clip.info, clip.frames.size(),
                                      [&](std::uint64_t i) { return clip.frames[i]; });
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kSource;
  std::vector<HapticFrame> frames;
  const server::DepthRange fallback{0.0, 1.0};
  server::DepthRange range;
  if (offline) {
    server::OfflineVision vision(source, source.info(), settings);
    vision.scan(nullptr);
    while (auto result = vision.next()) frames.push_back(std::move(result->frame));
    range = vision.vision().mapped() ? vision.vision().mapped()->range : fallback;
  } else {
    server::Vision vision(source.info(), settings);
    vision.scan(source, nullptr);
    while (auto frame = source.read()) {
      auto result = vision.push(*frame, mediaTime(double(frame->index) / clip.info.fps));
      if (result) frames.push_back(std::move(result->frame));
    }
    for (server::VisionResult& result : vision.flush()) frames.push_back(std::move(result.frame));
    range = vision.mapped() ? vision.mapped()->range : fallback;
  }
  ErrorSums sums(clip, range);
  for (const HapticFrame& frame : frames) sums.add(frame);
  return sums.errors();
}

/// A relief scene under a hand.
struct Touched {
  TouchScene scene;
  Hand hand;
};

std::vector<Touched> touchedScenes(bool quick) {
  const auto sliding = [](const TouchScene& scene, double reach_mm) {
    return Touched{scene, slidingHand(scene, reach_mm)};
  };
  const TouchScene plate = swingingPlate();
  const TouchScene dome = breathingDome();
  std::vector<Touched> out{sliding(stillSphere(), 12.0),
                           sliding(movingSphere(10), 9.0),
                           {plate, stillHand(plate, {2.0, 1.0, 7.0})},
                           {dome, stillHand(dome, {1.37, -0.81, 16.0})},
                           sliding(syntheticScene(server::SceneKind::kBounce), 6.0),
                           sliding(syntheticScene(server::SceneKind::kApproach), 8.0),
                           sliding(syntheticScene(server::SceneKind::kTumble), 6.0),
                           sliding(syntheticScene(server::SceneKind::kStill), 6.0)};
  if (quick) return out;
  out.push_back(sliding(stillEllipsoid(), 10.0));
  out.push_back(sliding(stillSinusoid(), 18.0));
  out.push_back(sliding(movingSphere(2), 9.0));
  out.push_back(sliding(movingSphere(40), 9.0));
  out.push_back(sliding(spinningEllipsoid(), 10.0));
  return out;
}

ForceError measureTouch(const Touched& touched, bool offline) {
  constexpr double kLongest_s = 6.0;
  StreamKind kind;
  kind.scan = true;
  kind.offline = offline;
  kind.longest_s = kLongest_s;
  const ForceTrace trace =
      renderTrace(makeStream(touched.scene, kind), defaultVariant(), touched.hand);
  double square = 0, count = 0;
  for (const Tick& tick : trace.ticks) {
    if (!tick.trulyTouches()) continue;
    square += tick.error_mm().squaredNorm();
    count += 1;
  }
  return {kStiffness_N_mm * std::sqrt(square / std::max(1.0, count)), 0.0};
}

struct Case {
  std::string name;
  std::function<std::pair<ForceError, ForceError>()> measure;  // live, bake
};

std::vector<Case> cases(bool quick) {
  std::vector<Case> out;
  for (const Touched& touched : touchedScenes(quick)) {
    out.push_back({touched.scene.name, [=] {
                     return std::pair(measureTouch(touched, false), measureTouch(touched, true));
                   }});
  }
  for (const NamedBakeClip& named : bakeClips(quick)) {
    out.push_back({named.name, [=] {
                     const BakeClip clip = named.draw();
                     return std::pair(measureClip(clip, false), measureClip(clip, true));
                   }});
  }
  return out;
}

double ratioOf(double bake_N, double live_N) {
  return (bake_N + kNothing_N) / (live_N + kNothing_N);
}

}  // namespace

static void evaluateBake(const Options& options) {
  Report report("bake", options);
  const std::vector<Case> all = cases(options.quick);
  std::vector<std::pair<ForceError, ForceError>> errors(all.size());
  onAllCores(all.size(), [&](std::size_t i) {
    errors[i] = all[i].measure();
    const auto& [live, bake] = errors[i];
    std::fprintf(stderr, "%-34s %.5f + %.5f N, %.5f + %.5f N, %.3f\n", all[i].name.c_str(),
                 live.static_N, live.dynamic_N, bake.static_N, bake.dynamic_N,
                 ratioOf(bake.sum_N(), live.sum_N()));
  });
  Table lines{{"scene", "live, N", "bake, N", "ratio", "ratio of the static force"}};
  double worst = 0, logs = 0, static_logs = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [live, bake] = errors[i];
    const double ratio = ratioOf(bake.sum_N(), live.sum_N());
    const double static_ratio = ratioOf(bake.static_N, live.static_N);
    lines.push_back({all[i].name, text("%.5f", live.sum_N()), text("%.5f", bake.sum_N()),
                     text("%.3f", ratio), text("%.3f", static_ratio)});
    report.add({all[i].name, "force", "bake", bake.sum_N(), "N rms", 0.0, true, false});
    report.add({all[i].name, "force", "live", live.sum_N(), "N rms", 0.0, false, false});
    worst = std::max({worst, ratio, static_ratio});
    logs += std::log(ratio);
    static_logs += std::log(static_ratio);
  }
  const auto count = double(all.size());
  report.addTable("scenes", lines);
  report.add(Goal{"bake over live, worst scene", "ratio", kMostWorse, 1.0, worst});
  report.add(Goal{"bake over live, geometric mean", "ratio", 1.0, 0.7, std::exp(logs / count)});
  report.add(Goal{"bake over live, static force, geometric mean", "ratio", 1.0, 0.7,
                  std::exp(static_logs / count)});
  report.write();
}

const RegisteredTopic kBakeTopic(
    "bake",
    {.about = "the force of a baked clip beside that of the live server; 10 minutes on two cores",
     .method = "The force of a recording that `bake` computed, and of the live stream of the same "
               "clip, after the live server's scan. Relief scenes: the force along a scripted path "
               "of a hand. Bodies through sensors of depth, and things held in hands, with exact "
               "masks: rms error of the heights 5 px and more inside the object at 0.5 N/mm, plus "
               "rms error of the acceleration at 0.5 kg, 0.1 s and more from an impact.",
     .evaluate = evaluateBake});

}  // namespace hapticast::evaluate
