// SPDX-License-Identifier: MIT
// Video object segmentation: decides in each frame which pixels belong to which object. There is
// one interface, with one implementation for each method. The methods are the source's own masks
// (make_segmenter.cpp), the thesis's edge fusion (edges.cpp), and narrow-band tracking after an
// initial mask (follow/narrow_band_tracker.hpp). Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"

namespace hapticast::server {

/// Segment: the pixels of one object in one frame.
struct Segment {
  /// Id of the object; an object that was lost and found again has a new one.
  std::uint32_t id = 0;
  cv::Mat mask;  ///< CV_8UC1, 0/255, image size; read-only
  /// 1: decided by this frame's pixels; less: only moved from the last frame.
  double quality = 1.0;
  /// Number of the object for the author, from 1: see AuthorPoint. It is the same after the object
  /// was lost and found again.
  int number = 0;
};

/// Segments the frames of one clip.
class Segmenter {
 public:
  virtual ~Segmenter() = default;
  /// Returns the segments of all objects that are visible in this frame. It omits lost objects.
  /// After a cut it also omits all objects of the old scene. `flows`: motion of the last frame's
  /// objects. Throws SourceError if an object point lies on no object.
  virtual std::vector<Segment> next(const FramePair& frames, const Flows& flows) = 0;
  /// Returns whether an annotation changes the masks of this frame: one of this frame, or the mask
  /// that the scan propagated from a later one. Such a frame must be processed even if all objects
  /// rest. Call it before next().
  [[nodiscard]] virtual bool hasAnnotation(const FramePair& /*frames*/) const { return false; }
};

/// Area below which an object counts as lost, px. The value is a choice: in a picture 640 px wide,
/// a square of this area is 1.6 nominal mm wide.
inline constexpr int kSmallestObject_px = 40;

/// Throws a SourceError whose message says that no object is at the author's point `point_px`.
/// `why`: the cause, as text for the message.
[[noreturn]] void throwNoObject(const Vec2& point_px, const std::string& why);

}  // namespace hapticast::server
