// SPDX-License-Identifier: MIT
// What the author of a stream may decide about vision. Plain values without OpenCV, so that the
// command line needs none. Thread: any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// How objects are found in a frame; what each kind does is told in segment/segment.hpp.
enum class SegmentMode : std::uint8_t { kAuto, kBand, kEdges, kSource };
/// How their motion is measured; see motion/pose_tracker.hpp.
enum class MotionMode : std::uint8_t { kAuto, kRgbd, kLk, kDepth, kNone };

/// The parts of a frame's way that may be left out; see scene_plan.hpp.
enum class Stage : std::uint8_t {
  kSegment,  ///< which pixels are the object's
  kClean,    ///< background depth rejected at the rim, holes filled
  kSmooth,   ///< local quadratic fit of the heights
  kMotion,   ///< alignment with the last frame
  kGrid,     ///< motion in cells of what the alignment leaves over
  kHeights,  ///< heights sent (when off: only once a second, and to who joins)
};
inline constexpr std::array<std::string_view, 6> kStageNames{"segment", "clean", "smooth",
                                                             "motion",  "grid",  "heights"};
inline constexpr std::size_t kStages = kStageNames.size();

struct PlanSettings {
  bool everything = false;                            ///< nothing is left out
  std::array<std::optional<bool>, kStages> forced{};  ///< the author's word, by stage
  /// A tenth of what a hand can tell apart: 7 % (Pang, Tan and Durlach 1991, discrimination of
  /// force by the fingers) of a touch of 1 N.
  double error_budget_N = 0.007;
};

/// What the author points at, and when.
struct AuthorPoint {
  Vec2 at_px = Vec2::Zero();
  double time_s = 0.0;  ///< in the clip; 0: its first frame. Not negative
  bool operator==(const AuthorPoint&) const = default;
};

/// The places of those that speak of the first frame.
inline std::vector<Vec2> pointsAtStart_px(const std::vector<AuthorPoint>& points) {
  std::vector<Vec2> out;
  out.reserve(points.size());
  for (const AuthorPoint& point : points) {
    if (point.time_s == 0.0) out.push_back(point.at_px);
  }
  return out;
}

inline constexpr double kUsualStiffness_N_mm = 0.5;  ///< of an Omni, the default of the viewers

struct VisionSettings {
  Method method = Method::kHapticast;
  SegmentMode segment = SegmentMode::kAuto;
  MotionMode motion = MotionMode::kAuto;
  std::vector<AuthorPoint> object_points;  ///< --object; empty: the nearest compact object
  std::vector<AuthorPoint> not_points;     ///< --not
  std::optional<DepthRange> depth_range;   ///< --depth-range: what levels of 8-bit depth mean
  std::optional<DepthRange> map_range;     ///< --map-range: the depths that become heights
  std::optional<double> fov_deg;           ///< --fov, 10..170; overrules the source's camera
  bool stretch = false;
  Material material;              ///< --stiffness, --friction
  std::optional<double> mass_kg;  ///< --mass
  PlanSettings plan;              ///< --plan, --error-budget
  /// --low-latency: one frame of lookahead; impacts only in a clip that was scanned.
  bool low_latency = false;
  /// --compensate-pan: accelerations and impacts against the background instead of the picture.
  bool compensate_pan = false;

  /// What a touch is reckoned with: the author's, else the usual one.
  [[nodiscard]] double stiffness_N_mm() const {
    return material.stiffness_N_mm.value_or(kUsualStiffness_N_mm);
  }
  /// Whether motion is measured at all: --motion, --plan.
  [[nodiscard]] bool moves() const {
    return motion != MotionMode::kNone &&
           plan.forced[static_cast<std::size_t>(Stage::kMotion)].value_or(true);
  }
};

}  // namespace hapticast::server
