// SPDX-License-Identifier: MIT
// The part of vision that does not need the clip's range: frame in, objects with their surface and
// pose out. Used once to scan a clip and once to broadcast it. Who lives is decided here; what an
// object does in a frame is Track's. Thread: vision's.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/background.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/track.hpp"

namespace hapticast::server {

class Tracker {
 public:
  /// `next_id` is counted up; it and `lessons` must outlive the tracker. `settings` and `info` are
  /// copied. `clock` tells how long stages take; null: nobody asks.
  Tracker(const SourceInfo& info, const VisionSettings& settings, const Clock* clock,
          std::uint32_t& next_id, ClipAnnotations& annotations);

  /// The objects of the next frame, also those just lost (for Track::kKeepLost frames, quality
  /// falling to 0). Throws SourceError (a frame that does not fit the announcement, an object point
  /// on nothing).
  std::vector<TrackedObject> next(const RgbdFrame& frame, double time_s);
  [[nodiscard]] const DepthNoise& noise() const { return frames_.noise(); }
  /// Whether the last frame shows another scene than those before: its objects are all new.
  [[nodiscard]] bool sceneCut() const { return scene_cut_; }

 private:
  [[nodiscard]] cv::Mat objectsMask() const;
  void segment(const FramePair& frames);
  void updateBackground(const FramePair& frames);
  void updateTracks(const FramePair& frames);

  TrackSettings settings_;
  std::uint32_t& next_id_;
  ClipAnnotations* annotations_;  // null: a live source
  FramePairs frames_;
  BackgroundMotion background_;
  std::unique_ptr<Segmenter> segmenter_;
  std::vector<Segment> segments_;  // of the last frame
  std::vector<Track> tracks_;
  bool scene_cut_ = false;
};

}  // namespace hapticast::server
