// SPDX-License-Identifier: MIT
// Vision pipeline of a frame: segment -> enhance -> motion -> describe. Its input is images with
// their times. Its output is structs. It has no sockets. With two threads, a task describes frame n
// while frame n + 1 is segmented: both have the same results as with one thread. Thread: at most
// one at a time (other files: "the one that runs Vision").
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
#include "server/vision/vision_result.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Switches off OpenCV's own threads in this program: they would compete with the program's
/// threads. Thread: any, before others call OpenCV.
void stopOpenCvThreads();

/// Converts the images of one source to haptic frames.
class Vision {
 public:
  /// Throws SourceError if settings and source do not fit, for example if an object point lies
  /// outside the picture. `clock` measures durations of stages for plan() and must outlive Vision;
  /// null: no measurement.
  Vision(const SourceInfo& info, VisionSettings settings, const Clock* clock = nullptr);
  ~Vision();

  /// Function that scan() calls after each frame, with the numbers of frames done and of all
  /// frames. It returns whether the scan should continue.
  using Progress = std::function<bool(std::uint64_t done, std::uint64_t total)>;
  /// Processes a whole recorded clip to find its mapped range, motion and largest acceleration.
  /// Then it rewinds the clip. Returns false if `progress` ended the scan, otherwise true. A scan
  /// that was ended has no results. Does nothing for a live source. Also does nothing if the author
  /// stated the range and motion is off. `progress` may be null. Throws SourceError.
  bool scan(RgbdSource& source, const Progress& progress);

  /// Adds the next frame, and returns the frame that is complete now (VisionResult). Returns
  /// nullopt if no frame is complete yet. `media_time` must increase with each frame. A new epoch
  /// begins at a scene cut. It also begins at a new epoch of the source, unless all objects
  /// continue there unchanged. Throws SourceError.
  [[nodiscard]] std::optional<VisionResult> push(const RgbdFrame& frame, MediaTime media_time);
  /// Replaces material and mass, of all objects and of each object that the author described, by
  /// those of `from`. The next push() is the first one that uses them. `from` must describe the
  /// same objects as the settings of the constructor.
  void setMaterials(const VisionSettings& from);
  /// Returns the frames that push() has not returned yet, oldest first. Call it at the end of the
  /// stream.
  [[nodiscard]] std::vector<VisionResult> flush();

  /// Returns the scene plan of each object of the last added frame, by object id. With two threads
  /// the measurements of the second thread are those of the frame before.
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plan() const;

  /// Makes the next frame begin a new epoch, even if no object has changed. Call it after flush().
  void beginAnew();

  /// Returns the name of object `id` in the author's scene; empty if it has no name there.
  [[nodiscard]] std::string name(std::uint32_t id) const;

  /// Returns the mapped range: the depths that become heights 30 and 0. Returns nullopt before it
  /// is known. It is the range that the author stated (--map-range), if any. Otherwise scan() finds
  /// it for a recorded clip. For a live source it is found in the first frame with an object.
  [[nodiscard]] const std::optional<MappedRange>& mapped() const;

  /// Returns the description of the stream for the viewers' welcome. It is complete after scan()
  /// for a recorded clip, and after the first frame for a live source.
  [[nodiscard]] const StreamDescription& description() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
