// SPDX-License-Identifier: MIT
// Savings of the plan in time and bytes, and its cost in force, against everything on; and
// how many frames a second the whole server makes, up to the bytes.
#include <algorithm>
#include <chrono>
#include <cmath>

#include "server/source/synthetic/synthetic_source.hpp"
#include "server/stream/encoded.hpp"
#include "server/vision/vision.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kStiffness_N_mm = 0.5;

struct Clip {
  std::string name;
  server::SourceInfo info;
  std::vector<server::RgbdFrame> frames;
  server::VisionSettings settings;
};

struct Run {
  std::vector<server::VisionResult> results;
  double time_us = 0;  // per frame, the first ones (the start) left out
  double bytes = 0;    // per frame
};

Run run(const Clip& clip, bool everything) {
  server::VisionSettings settings = clip.settings;
  settings.plan.everything = everything;
  server::Vision vision(clip.info, settings);
  server::FrameEncoder encoder;
  Run out;
  std::size_t counted = 0;
  const std::size_t settled = clip.frames.size() / 2;
  for (std::size_t i = 0; i < clip.frames.size(); ++i) {
    const double start_us = threadTime_us();
    auto result = vision.push(clip.frames[i], mediaTime(double(i) / clip.info.fps));
    std::size_t bytes = 0;
    if (result) bytes = encoder.encode(result->frame).delta->size();
    if (i >= settled) {
      out.time_us += threadTime_us() - start_us;
      out.bytes += double(bytes);
      ++counted;
    }
    if (result) out.results.push_back(std::move(*result));
  }
  out.time_us /= double(counted);
  out.bytes /= double(counted);
  return out;
}

// Rms over frames of the change of the force at a finger 1 mm deep, all over the object.
double forceApart_N(const Clip& clip, const Run& plan, const Run& everything) {
  Workspace workspace;
  workspace.width_px = clip.info.width_px;
  workspace.height_px = clip.info.height_px;
  double square = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < plan.results.size(); ++i) {
    const auto& a = plan.results[i].frame.objects;
    const auto& b = everything.results[i].frame.objects;
    for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
      if (!(a[k].relief->rect == b[k].relief->rect)) continue;
      square += std::pow(server::forceDifference_N(*a[k].relief, *b[k].relief,
                                                   workspace.mmPerPixel().x(), kStiffness_N_mm),
                         2);
      ++count;
    }
  }
  return count > 0 ? std::sqrt(square / double(count)) : 0.0;
}

// Where the object's centre is in the first picture.
Vec2 objectAt(const TestSource& source) {
  return source.view().workspace.toImage(source.centreAt(0.0).position_mm.head<2>());
}

std::vector<Clip> clips(bool quick) {
  std::vector<Clip> out;
  for (const server::SceneName& scene : server::kSceneNames) {
    Clip clip;
    clip.name = "synthetic:" + std::string(scene.name);
    server::SyntheticSource source(scene.kind);
    clip.info = source.info();
    while (auto frame = source.read()) clip.frames.push_back(std::move(*frame));
    out.push_back(std::move(clip));
  }
  struct Noisy {
    const char* name;
    Sensor::Depth depth;
  };
  for (const Noisy& noisy :
       {Noisy{"stereo", Sensor::Depth::kStereo}, Noisy{"tof", Sensor::Depth::kTimeOfFlight},
        Noisy{"8 bit", Sensor::Depth::kEightBit}}) {
    for (const TestScene& scene : segmentationScenes()) {
      if (scene.name != "still" && (quick || scene.name == "ball_same")) continue;
      TestScene longer = scene;
      if (scene.name == "still") longer.duration_s = 4.0;
      Sensor sensor;
      sensor.depth = noisy.depth;
      TestSource source(longer, sensor, 25.0, false);
      Clip clip;
      clip.name = scene.name + ", " + noisy.name;
      clip.info = source.info();
      clip.settings.object_points = {{objectAt(source)}};
      while (auto frame = source.read()) clip.frames.push_back(std::move(*frame));
      out.push_back(std::move(clip));
    }
  }
  return out;
}

void sustained(Report& report, int width_px, int height_px, bool own_mask) {
  TestScene scene = motionScenes()[3];  // general
  scene.duration_s = 2.0;
  Sensor sensor;
  sensor.depth = Sensor::Depth::kTimeOfFlight;
  TestSource source(scene, sensor, 25.0, !own_mask, width_px, height_px);
  std::vector<server::RgbdFrame> frames;
  while (auto frame = source.read()) frames.push_back(std::move(*frame));
  server::VisionSettings settings;
  settings.object_points = {{objectAt(source)}};
  server::Vision vision(source.info(), settings);
  server::FrameEncoder encoder;
  (void)vision.push(frames[0], mediaTime(0));  // the careful start is no frame's time
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const auto result = vision.push(frames[i], mediaTime(double(i) / 25.0));
    if (result) (void)encoder.encode(result->frame);
  }
  const double wall_us =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() /
      double(frames.size() - 1);
  report.add({std::to_string(width_px) + "x" + std::to_string(height_px), "frames_per_second",
              own_mask ? "band" : "source mask", 1e6 / wall_us, "1/s", wall_us, own_mask, false});
}

}  // namespace

static void evaluatePlan(const Options& options) {
  Report report("plan", options);
  for (const Clip& clip : clips(options.quick)) {
    const Run plan = run(clip, false);
    const Run everything = run(clip, true);
    report.add({clip.name, "added_force", "plan", forceApart_N(clip, plan, everything), "N",
                plan.time_us, true, false});
    report.add({clip.name, "bytes", "plan", plan.bytes, "bytes/frame", plan.time_us, true, false});
    report.add({clip.name, "bytes", "everything", everything.bytes, "bytes/frame",
                everything.time_us, false, false});
  }
  for (const bool own_mask : {false, true}) {
    sustained(report, 640, 480, own_mask);
    if (!options.quick) sustained(report, 1920, 1080, own_mask);
  }
  report.write();
}

const RegisteredTopic kPlanTopic(
    "plan", {.about = "what the plan saves and costs; frames a second of the whole server",
             .method = "Time and bytes that the scene plan saves, and what it changes of the force "
                       "of a finger 1 mm deep at 0.5 N/mm (`added_force`, the budget is 0.007 N). "
                       "The truth is the second half of the same clip with every stage on. More "
                       "`frames_per_second` are better. All on one thread.",
             .evaluate = evaluatePlan});

}  // namespace hapticast::evaluate
