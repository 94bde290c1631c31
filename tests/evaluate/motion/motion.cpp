// SPDX-License-Identifier: MIT
// Velocity, acceleration and impacts of every estimator against exact truth.
#include <algorithm>
#include <cmath>

#include "server/vision/vision.hpp"
#include "tests/evaluate/motion/motion_clips.hpp"
#include "tests/evaluate/motion/motion_filters.hpp"
#include "tests/evaluate/thread_time.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/scenes/body_scene.hpp"

namespace hapticast::evaluate {

namespace {

using server::MotionMode;

struct Variant {
  const char* name;
  MotionMode motion;
  Method method = Method::kHapticast;
  bool compensate_pan = false;
};

struct Case {
  std::string name;
  TestScene scene;
  Sensor sensor;
  bool large = false;  ///< 1920x1080 instead of 640x480, of the default estimator only
};

struct Errors {
  double velocity_px = 0;   // rms per frame, x and y
  double z_levels = 0;      // rms per frame
  double acceleration = 0;  // rms over rms of the truth
  double acceleration_mm_s2 = 0;
  double true_mm_s2 = 0;
  std::size_t impacts_found = 0, impacts_true = 0, impacts_false = 0;
  double impact_ms = 0, impact_share = 0;  // worst
  double time_us = 0;
  std::size_t frames = 0, without = 0;
};

bool nearImpact(const TestScene& scene, double time_s, double reach_s) {
  return std::any_of(scene.impacts_s.begin(), scene.impacts_s.end(),
                     [&](double t) { return std::abs(t - time_s) <= reach_s; });
}

// `clip`: every frame of `source`, drawn once for all variants.
Errors run(const Case& what, const Variant& variant, const TestSource& source,
           const std::vector<server::RgbdFrame>& clip) {
  const double fps = source.info().fps;
  server::VisionSettings settings;
  settings.motion = variant.motion;
  settings.method = variant.method;
  settings.compensate_pan = variant.compensate_pan;
  settings.segment = server::SegmentMode::kSource;
  const ThreadClock clock;
  server::Vision vision(source.info(), settings, &clock);
  std::vector<server::VisionResult> results;
  Errors out;
  for (const server::RgbdFrame& frame : clip) {
    auto result = vision.push(frame, mediaTime(double(frame.index) / fps));
    for (const auto& [id, lines] : vision.plan())
      out.time_us = 1e3 * lines[static_cast<std::size_t>(server::Stage::kMotion)].saves_ms;
    if (result) results.push_back(std::move(*result));
  }
  const double mm_per_px = source.view().workspace.mmPerPixel().x();
  double v2 = 0, z2 = 0, a2 = 0, truth2 = 0;
  std::vector<Impact> found;
  const double lookahead_s = toSeconds(vision.description().pipeline_latency);
  for (const server::VisionResult& result : results) {
    const double t = toSeconds(result.frame.media_time);
    if (t < lookahead_s + 0.5 / fps || t > what.scene.duration_s - lookahead_s - 1.5 / fps)
      continue;
    if (result.frame.objects.empty()) {
      ++out.without;
      continue;
    }
    const Motion truth = source.centreAt(t);
    const Motion& motion = result.frame.objects[0].motion;
    const Vec3 dv = (motion.velocity_mm_s - truth.velocity_mm_s) / fps;
    for (const Impact& impact : result.frame.objects[0].impacts) {
      if (found.empty() || impact.time > found.back().time) found.push_back(impact);
    }
    ++out.frames;
    if (nearImpact(what.scene, t, 1.0 / fps)) continue;
    v2 += dv.head<2>().squaredNorm() / (mm_per_px * mm_per_px);
    z2 += std::pow(dv.z() / (30.0 / 255.0), 2);
    a2 += (motion.acceleration_mm_s2 - truth.acceleration_mm_s2).squaredNorm();
    truth2 += truth.acceleration_mm_s2.squaredNorm();
  }
  const double n = std::max<double>(1.0, double(out.frames));
  out.velocity_px = std::sqrt(v2 / n);
  out.z_levels = std::sqrt(z2 / n);
  out.acceleration_mm_s2 = std::sqrt(a2 / n);
  out.true_mm_s2 = std::sqrt(truth2 / n);
  out.acceleration = truth2 > 1.0 ? std::sqrt(a2 / truth2) : 0.0;
  for (const double t : what.scene.impacts_s) {
    if (t < 4.0 / fps || t > what.scene.duration_s - 2 * lookahead_s - 2.0 / fps) continue;
    ++out.impacts_true;
    const Vec3 before = source.centreAt(t - 1e-6).velocity_mm_s;
    const Vec3 delta = source.centreAt(t + 1e-6).velocity_mm_s - before;
    for (const Impact& impact : found) {
      const double off_ms = 1e3 * std::abs(toSeconds(impact.time) - t);
      if (off_ms > 500.0 / fps) continue;
      ++out.impacts_found;
      out.impact_ms = std::max(out.impact_ms, off_ms);
      out.impact_share =
          std::max(out.impact_share, (impact.delta_velocity_mm_s - delta).norm() / delta.norm());
      break;
    }
  }
  for (const Impact& impact : found) {
    if (!nearImpact(what.scene, toSeconds(impact.time), 0.5 / fps)) ++out.impacts_false;
  }
  return out;
}

std::vector<Case> cases(bool quick) {
  Sensor usual;
  usual.depth = Sensor::Depth::kEightBit;
  usual.mask_wobble_px = 1.5;
  std::vector<Case> out;
  for (const TestScene& scene : motionScenes()) {
    const bool short_list = scene.name == "bounce_real" || scene.name == "zsin" ||
                            scene.name == "general" || scene.name == "ellipsoid" ||
                            scene.name == "static";
    if (quick && !short_list) continue;
    out.push_back({scene.name, scene, usual});
    if (scene.name != "general") continue;
    Case noisy{"noise5", scene, usual};
    noisy.sensor.color_noise = 5.0;
    noisy.sensor.depth_noise_mm = 5.5;  // two levels
    Case coarse{"zq8", scene, usual};
    coarse.sensor.levels_per_step = 8;
    Case exact{"exact masks", scene, usual};
    exact.sensor.mask_wobble_px = 0;
    Case stereo{"stereo", scene, usual};
    stereo.sensor.depth = Sensor::Depth::kStereo;
    Case flight{"tof", scene, usual};
    flight.sensor.depth = Sensor::Depth::kTimeOfFlight;
    Case shifted{"shift 2 px", scene, usual};
    shifted.sensor.misalignment_px = 2;
    Case far{"shift 4 px", scene, usual};
    far.sensor.misalignment_px = 4;
    const Case large{"1920x1080", scene, usual, true};
    for (const Case& more : {noisy, coarse, exact, stereo, flight, shifted, far, large})
      out.push_back(more);
  }
  return out;
}

constexpr server::DepthRange kDesk{400.0, 1200.0};  // of what stands on it
const RealObject kRealObjects[] = {
    {"visp_rbt_desk", "dragon", {505, 330}, kDesk, 99},
    {"visp_rbt_desk", "cube", {270, 300}, kDesk, 99},
    {"visp_rbt_desk", "phantom", {430, 270}, kDesk, 99},
    {"tum_fr1_rpy", "monitor", {230, 130}, {500.0, 2000.0}, 36},
};

}  // namespace

static void evaluateMotion(const Options& options) {
  Report report("motion", options);
  const Variant variants[] = {
      {"rgbd", MotionMode::kRgbd},
      {"lk", MotionMode::kLk},
      {"depth", MotionMode::kDepth},
      {"rgbd, pan compensated", MotionMode::kRgbd, Method::kHapticast, true},
      {"thesis", MotionMode::kAuto, Method::kThesis}};
  for (const double fps : {25.0, 60.0}) {
    for (const Case& what : cases(options.quick)) {
      if (!options.only.empty() && what.name != options.only) continue;
      if (what.large && fps != 25.0) continue;
      TestSource source(what.scene, what.sensor, fps, true, what.large ? 1920 : 640,
                        what.large ? 1080 : 480);
      std::vector<server::RgbdFrame> clip;
      while (auto frame = source.read()) clip.push_back(std::move(*frame));
      if (what.scene.impacts_s.empty() && !what.large && what.name != "static" &&
          what.name != "rotonly")
        evaluateFilters(report, what.name + (fps == 25.0 ? "@25" : "@60"), source, clip);
      for (const Variant& variant : variants) {
        if (variant.compensate_pan && what.scene.pan_px == 0.0) continue;
        if (what.large && variant.motion != MotionMode::kRgbd) continue;
        const Errors e = run(what, variant, source, clip);
        const bool usual = variant.motion == MotionMode::kRgbd && !variant.compensate_pan;
        const std::string scene = what.name + (fps == 25.0 ? "@25" : "@60");
        report.add({scene, "velocity", variant.name, e.velocity_px, "px/frame", e.time_us, usual,
                    variant.method == Method::kThesis});
        report.add({scene, "velocity_z", variant.name, e.z_levels, "level/frame", e.time_us, usual,
                    variant.method == Method::kThesis});
        if (e.true_mm_s2 > 1.0) {
          report.add({scene, "acceleration", variant.name, 100 * e.acceleration, "%", e.time_us,
                      usual, variant.method == Method::kThesis});
        } else {
          report.add({scene, "false_acceleration", variant.name, e.acceleration_mm_s2, "mm/s2",
                      e.time_us, usual, variant.method == Method::kThesis});
        }
        if (e.impacts_true + e.impacts_false > 0) {
          std::fprintf(
              stderr, "             impacts %zu of %zu, %zu false, worst %.3f ms, %.2f %%\n",
              e.impacts_found, e.impacts_true, e.impacts_false, e.impact_ms, 100 * e.impact_share);
        }
        if (e.without > 0) std::fprintf(stderr, "             %zu frames without\n", e.without);
      }
    }
  }
  for (const Variant& variant : variants) {
    if (variant.method == Method::kThesis || variant.compensate_pan) continue;
    for (const RealObject& object : kRealObjects) {
      if (options.only.empty() || options.only == object.name)
        evaluateRealClip(report, object, variant.motion, variant.name);
    }
  }
  report.write();
}

const RegisteredTopic kMotionTopic(
    "motion",
    {.about = "velocity, acceleration and impacts of every estimator",
     .method = "Velocity and acceleration as viewers get them, of every estimator, and of the same "
               "poses through other windows (`acceleration_filter`). The truth is the exact path "
               "of the body's centre, and in real clips the camera's measured poses. Run times are "
               "of the stage alone, on one thread.",
     .evaluate = evaluateMotion});

}  // namespace hapticast::evaluate
