// SPDX-License-Identifier: MIT
// Multi-object tracking: finds the objects of each frame with their surfaces (depths in mm) and
// poses. It does not need the mapped range. It runs once to scan a clip and once to stream it.
// Tracker creates and removes tracks. Each Track processes one object in a frame. Thread: the one
// that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/background.hpp"
#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/track.hpp"

namespace hapticast::server {

/// Returns the camera of the settings or of the source, else a usual one. Thread: any.
[[nodiscard]] CameraModel selectCamera(const SourceInfo& info, const VisionSettings& settings);

/// Tracks all objects of one clip.
class Tracker {
 public:
  /// Copies `info` and `settings`. Each new object has the id `next_id`, which is then incremented.
  /// `next_id` and `annotations` must outlive the tracker. `clock` measures durations of stages;
  /// null: no measurement.
  Tracker(const SourceInfo& info, const VisionSettings& settings, const Clock* clock,
          std::uint32_t& next_id, ClipAnnotations& annotations);

  /// Returns the objects of the next frame, at most kMaxObjects. A lost object remains for
  /// Track::kKeepLost frames, in which its quality decreases to 0. `time_s`: media time, s. Throws
  /// SourceError if a frame does not match `info`, or if an object point lies on no object.
  std::vector<TrackedObject> next(const RgbdFrame& frame, double time_s);
  /// Decides which stages after the tracker run for `objects`, the result of next(). Call it after
  /// the reports of the frame before.
  void decideStages(std::vector<TrackedObject>& objects) const;
  /// Adds a later stage's measurements of the object `id` to its scene plan. Ignores an unknown
  /// object.
  void report(std::uint32_t id, const StageReport& report);
  /// Returns the scene plan of each object, by object id.
  [[nodiscard]] std::map<std::uint32_t, std::vector<PlanLine>> plans() const;
  [[nodiscard]] const DepthNoise& noise() const { return frames_.noise(); }
  /// Returns whether the last frame is the first one after a cut. All its objects are then new.
  [[nodiscard]] bool sceneCut() const { return scene_cut_; }

 private:
  [[nodiscard]] cv::Mat objectsMask() const;
  void segment(const FramePair& frames);
  void updateBackground(const FramePair& frames);
  void updateTracks(const FramePair& frames);

  TrackSettings settings_;
  std::uint32_t& next_id_;
  ClipAnnotations* annotations_;  // null for a live source
  FramePairs frames_;
  BackgroundMotion background_;
  std::unique_ptr<Segmenter> segmenter_;
  std::vector<Segment> segments_;  // segments of the last frame
  std::vector<Track> tracks_;
  bool scene_cut_ = false;
};

}  // namespace hapticast::server
