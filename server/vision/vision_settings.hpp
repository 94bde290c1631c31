// SPDX-License-Identifier: MIT
// Settings of vision that the author of a stream chooses. Plain values without OpenCV, so that the
// command line does not need it. Thread: any.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Method of segmentation; segment/segmenter.hpp describes each.
enum class SegmentMode : std::uint8_t { kAuto, kBand, kEdges, kSource };
/// Method of motion measurement; motion/pose_tracker.hpp describes each.
enum class MotionMode : std::uint8_t { kAuto, kRgbd, kLk, kDepth, kNone };

/// Stages that a scene plan can switch off (scene_plan.hpp).
enum class Stage : std::uint8_t {
  kSegment,  ///< decides which pixels belong to the object
  kClean,    ///< rejects depth of the background at the rim, and fills holes
  kSmooth,   ///< smooths the heights by a local quadratic fit
  kMotion,   ///< aligns the object with the last frame to measure its motion
  kGrid,     ///< measures in cells the motion that is not rigid
  kHeights,  ///< sends the heights; when off, only once a second and to new clients
};
inline constexpr std::array<std::string_view, 6> kStageNames{"segment", "clean", "smooth",
                                                             "motion",  "grid",  "heights"};
inline constexpr std::size_t kStages = kStageNames.size();

/// Settings of the scene plan.
struct PlanSettings {
  bool everything = false;  ///< true: all stages stay on
  /// The author's choice for each stage, on or off; nullopt: the plan decides.
  std::array<std::optional<bool>, kStages> forced{};
  /// Error budget, N: the change of force that an omitted stage may cause. The default is a tenth
  /// of the smallest difference that a hand perceives at 1 N. This difference is 7 % (Pang, Tan and
  /// Durlach 1991).
  double error_budget_N = 0.007;
};

/// Number of candidates for the first mask from which the author may pick.
inline constexpr int kMostCandidates = 3;

/// A point that the author marked in the picture at one time of the clip.
struct AuthorPoint {
  Vec2 at_px = Vec2::Zero();
  double time_s = 0.0;  ///< time in the clip, s, 0 or more; 0: its first frame
  int number = 0;       ///< number of its object, from 1; 0: vision decides which object it is
  /// Which of vision's candidates for the first mask the author picked: 1 (the best) to
  /// kMostCandidates. Of the first frame only.
  int candidate = 1;
  bool operator==(const AuthorPoint&) const = default;
};

/// Object that the author described. Its number is its position in VisionSettings::objects, from 1.
struct AuthorObject {
  std::string name;
  Material material;  ///< its own values, or those of all objects
  bool operator==(const AuthorObject&) const = default;
};

/// Stiffness that the haptic device Omni renders, N/mm. It is the viewers' default.
inline constexpr double kUsualStiffness_N_mm = 0.5;

/// Settings of vision, with the flags that set them.
struct VisionSettings {
  Method method = Method::kHapticast;
  SegmentMode segment = SegmentMode::kAuto;
  MotionMode motion = MotionMode::kAuto;
  /// --object: points on objects; empty: the nearest compact object.
  std::vector<AuthorPoint> object_points;
  std::vector<AuthorPoint> not_points;    ///< --not: points that are not on an object
  std::optional<DepthRange> depth_range;  ///< --depth-range: depths of the levels of 8-bit depth
  /// --map-range: the mapped range, instead of the measured one.
  std::optional<DepthRange> map_range;
  /// --fov: horizontal field of view, 10..170; overrides the source's camera.
  std::optional<double> fov_deg;
  std::string scene_file;             ///< --scene; empty: none
  std::vector<AuthorObject> objects;  ///< --scene: objects that the author described
  std::optional<CameraModel> camera;  ///< --scene: overrides the source's camera
  bool stretch = false;               ///< --stretch: each axis has its own scale
  Material material;                  ///< --stiffness, --friction: material of all objects
  std::optional<double> mass_kg;      ///< --mass: mass of an object
  PlanSettings plan;                  ///< --plan, --error-budget: settings of the scene plan
  /// --low-latency: one frame of lookahead. Impacts are then found only in a clip that was scanned.
  bool low_latency = false;
  /// --compensate-pan: accelerations and impacts are relative to the background, not to the
  /// picture.
  bool compensate_pan = false;
  /// --vision-threads: 2 describes a frame while the next one is segmented, and delays each frame
  /// by one more. 0: 2 for pictures larger than 640x480, if the machine has two processors and
  /// `low_latency` is off, else 1.
  std::uint64_t threads = 0;
  bool explain = false;  ///< --explain: log how the first mask was chosen
  /// bake: scan() reads the whole clip, and each result has what its frame alone measured.
  bool offline = false;

  /// Returns the material of the object with this number.
  [[nodiscard]] const Material& findMaterial(int number) const {
    const bool known = number >= 1 && static_cast<std::size_t>(number) <= objects.size();
    return known ? objects[static_cast<std::size_t>(number) - 1].material : material;
  }
  /// Returns the stiffness for estimates of force, N/mm: the largest stiffness of an object in
  /// these settings. Returns kUsualStiffness_N_mm if none is set.
  [[nodiscard]] double stiffness_N_mm() const {
    double largest = material.stiffness_N_mm.value_or(objects.empty() ? kUsualStiffness_N_mm : 0.0);
    for (const AuthorObject& object : objects) {
      largest = std::max(largest, object.material.stiffness_N_mm.value_or(kUsualStiffness_N_mm));
    }
    return largest;
  }
  /// Returns the --object points of the clip's first frame. Each one has a number: that of its
  /// object, or a free one.
  [[nodiscard]] std::vector<AuthorPoint> pointsAtStart() const {
    std::vector<AuthorPoint> out;
    int free = static_cast<int>(objects.size());
    for (AuthorPoint point : object_points) {
      if (point.time_s != 0.0) continue;
      if (point.number == 0) point.number = ++free;
      out.push_back(point);
    }
    return out;
  }
  /// Returns whether motion is measured at all. --motion and --plan can switch the measurement off.
  [[nodiscard]] bool moves() const {
    return motion != MotionMode::kNone &&
           plan.forced[static_cast<std::size_t>(Stage::kMotion)].value_or(true);
  }
};

}  // namespace hapticast::server
