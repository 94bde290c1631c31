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
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/range.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// One frame out of vision, `lookahead` frames after it went in.
struct VisionResult {
  HapticFrame frame;  ///< every present object carries its relief
  cv::Mat color;      ///< the picture of the same instant, CV_8UC3
};

class Vision {
 public:
  /// Throws SourceError (an object point outside the picture, ...). `clock` tells how long stages
  /// take, for plan(), and must outlive vision; null: nobody asks.
  Vision(const SourceInfo& info, VisionSettings settings, const Clock* clock = nullptr);
  ~Vision();

  /// Told after each frame of a scan; returns whether to go on.
  using Progress = std::function<bool(std::uint64_t done, std::uint64_t total)>;
  /// Goes through a recorded clip once for its clip-wide depth range and largest acceleration, then
  /// rewinds it; does nothing with a live source, or where the range is given and no motion asked
  /// for. False where `progress` (may be null) broke it off: nothing is known then.
  bool scan(RgbdSource& source, const Progress& progress);

  /// Takes the next frame in; returns the frame that is complete now, if any. `media_time`
  /// increases by frames. A frame of a new source epoch in which something has moved, a cut to
  /// another scene or a change of range starts a new stream epoch.
  [[nodiscard]] std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time);
  /// What is still inside at the end of the stream, oldest first.
  [[nodiscard]] std::vector<VisionResult> flush();

  /// What is left out of each object of the last frame taken in, by object id.
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const;

  /// The depths that become heights; nullopt while no object was seen. Found by scan() (recorded)
  /// or in the first frame with an object (live), if the author does not say.
  [[nodiscard]] const std::optional<MappedRange>& mapped() const;

  /// What to announce; complete after scan() (recorded) or the first frame (live).
  [[nodiscard]] const StreamDescription& description() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
