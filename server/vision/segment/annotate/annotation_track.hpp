// SPDX-License-Identifier: MIT
// Finds the author's annotations of each frame: points (flags --object and --not, with their times)
// and key masks. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Radius of the disc of pixels that a point of the author marks, px. The value is a choice.
inline constexpr int kPoint_px = 5;

/// Point on an object (--object).
struct ObjectPoint {
  cv::Point at_px;
  int number = 0;     ///< see AuthorPoint
  int candidate = 1;  ///< see AuthorPoint
  bool operator==(const ObjectPoint&) const = default;
};

/// The author's annotation of one frame.
struct Annotation {
  std::vector<ObjectPoint> on;
  std::vector<cv::Point> off;  ///< points that are not on the object (--not), px
  cv::Mat masks;               ///< key mask: empty, or CV_8UC1 with n for object n

  [[nodiscard]] bool empty() const { return on.empty() && off.empty() && masks.empty(); }
};

/// Stores the annotations of a clip and returns those of each frame.
class AnnotationTrack {
 public:
  /// Copies the points of `settings`.
  explicit AnnotationTrack(const VisionSettings& settings);

  /// Returns the points of the clip's first frame, without a key mask.
  [[nodiscard]] const Annotation& atStart() const { return start_; }
  /// Returns the annotations of the present frame of `frames`: its key mask, and the points whose
  /// times belong to it. A point belongs to the frame that is nearest to its time.
  [[nodiscard]] Annotation findAnnotation(const FramePair& frames) const;
  /// Returns whether the author marked an object (--object) at a time after the first frame.
  [[nodiscard]] bool pointsLater() const { return !on_.empty(); }
  /// Returns whether points of the author belong to frames after the present one. It does not count
  /// key masks, because those of later frames are unknown.
  [[nodiscard]] bool hasLaterAnnotation(const FramePair& frames) const;

 private:
  Annotation start_;
  std::vector<AuthorPoint> on_;  // points of later frames
  std::vector<AuthorPoint> off_;
};

/// Returns the mask (0/255, size of `view`) of the connected region of similar colour around `at`.
/// Colours are similar if they resemble the colours in the disc of `radius_px` around `at`.
cv::Mat findConnected(const GraphRoi& view, const cv::Point& at, int radius_px);

/// Returns the colours of the connected region of similar colour around `point` (px of the
/// picture). The result is empty if the region is narrower than 25 mm.
NegativeColors sampleColors(const FrameContext& scene, const cv::Point& point);
/// Adds the colours of `sample` to `colors`.
void addSample(const NegativeColors& sample, NegativeColors& colors);
/// Adds sampleColors() at `point` to `colors`.
void addNegativeSample(const FrameContext& scene, const cv::Point& point, NegativeColors& colors);

}  // namespace hapticast::server
