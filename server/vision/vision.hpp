// SPDX-License-Identifier: MIT
// Vision pipeline of a frame: segment -> enhance -> motion -> describe. Images and times in,
// structs out. It has no threads, clocks or sockets. Thread: one at a time, the one that runs
// Vision.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/range.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// A complete frame, `lookahead` frames after its push.
struct VisionResult {
  HapticFrame frame;  ///< with the reliefs of all its objects
  cv::Mat color;      ///< picture of the same instant, CV_8UC3, BGR
};

/// Vision of one source.
class Vision {
 public:
  /// Throws SourceError (for example, an object point outside the picture). `clock` measures
  /// durations of stages for plan() and must outlive Vision; null: no measurement.
  Vision(const SourceInfo& info, VisionSettings settings, const Clock* clock = nullptr);
  ~Vision();

  /// Called after each frame of a scan, with counts of frames. Returns whether to continue.
  using Progress = std::function<bool(std::uint64_t done, std::uint64_t total)>;
  /// Scans a recorded clip for its mapped range, motion and largest acceleration, then rewinds it.
  /// Does nothing for a live source, or if the range is stated and no motion is measured.
  /// Returns false if `progress` (may be null) ended the scan; then it has no results. Throws
  /// SourceError.
  bool scan(RgbdSource& source, const Progress& progress);

  /// Adds the next frame; returns the frame that is complete now, if any. `media_time` increases
  /// with each frame.
  /// A new epoch starts at a scene cut, and at a new source epoch in which an object moved. Throws
  /// SourceError.
  [[nodiscard]] std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time);
  /// Returns the remaining frames at the end of the stream, oldest first.
  [[nodiscard]] std::vector<VisionResult> flush();

  /// Returns the plan of each object of the last added frame, by object id.
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const;

  /// Returns the depths that become heights; nullopt before the first object was seen. The author
  /// sets them, or scan() (recorded) or the first frame with an object (live) finds them.
  [[nodiscard]] const std::optional<MappedRange>& mapped() const;

  /// Returns the description to announce; complete after scan() (recorded) or the first frame
  /// (live).
  [[nodiscard]] const StreamDescription& description() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
