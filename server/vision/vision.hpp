// SPDX-License-Identifier: MIT
// The way of a frame through vision: segment -> enhance -> motion -> describe. Images and times in,
// structs out; no threads, clocks or sockets.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/scene_plan.hpp"

namespace hapticast::server {

enum class SegmentMode : std::uint8_t { kAuto, kBand, kEdges, kSource };
enum class MotionMode : std::uint8_t { kAuto, kRgbd, kLk, kDepth, kNone };

struct VisionSettings {
  Method method = Method::kHapticast;
  SegmentMode segment = SegmentMode::kAuto;
  MotionMode motion = MotionMode::kAuto;
  std::vector<Vec2> object_points_px;     ///< --object; empty: the nearest compact object
  std::vector<Vec2> not_points_px;        ///< --not
  std::optional<DepthRange> depth_range;  ///< --depth-range
  bool stretch = false;
  Material material;              ///< --stiffness, --friction
  std::optional<double> mass_kg;  ///< --mass
  PlanSettings plan;              ///< --plan, --error-budget
  /// --low-latency: one frame of lookahead; impacts only in a clip that was scanned.
  bool low_latency = false;
  /// --compensate-pan: accelerations and impacts against the background instead of the picture.
  bool compensate_pan = false;
  const Clock* clock = nullptr;  ///< to tell how long stages take; null: nobody asks
};

/// One frame out of vision, `lookahead` frames after it went in.
struct VisionResult {
  HapticFrame frame;  ///< every present object carries its relief
  cv::Mat color;      ///< the picture of the same instant, CV_8UC3
};

class Vision {
 public:
  /// Throws SourceError (an object point outside the picture, ...).
  Vision(const SourceInfo& info, VisionSettings settings);
  ~Vision();

  /// Looks through a recorded clip once for its clip-wide depth range and largest acceleration,
  /// then rewinds it. Does nothing where both are known. `progress(done, total)` is called now and
  /// then.
  void scan(RgbdSource& source, const std::function<void(std::uint64_t, std::uint64_t)>& progress);

  /// Takes the next frame in; returns the frame that is complete now, if any. `media_time`
  /// increases by frames. A frame of a new source epoch, a cut to another scene or a change of
  /// range starts a new stream epoch.
  [[nodiscard]] std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time);
  /// What is still inside at the end of the stream, oldest first.
  [[nodiscard]] std::vector<VisionResult> flush();

  /// What is left out of each object of the last frame taken in, by object id.
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const;

  /// What to announce; complete after scan() (recorded) or the first frame (live).
  [[nodiscard]] const StreamDescription& description() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
