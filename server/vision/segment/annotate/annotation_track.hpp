// SPDX-License-Identifier: MIT
// Annotations of the author by frame: points (--object and --not, with their times) and key masks.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

inline constexpr int kPoint_px = 5;  ///< radius of the pixels that a point means; chosen

/// The author's annotation of one frame.
struct Annotation {
  std::vector<cv::Point> on;   ///< points on the object, px
  std::vector<cv::Point> off;  ///< points on other objects, px
  cv::Mat masks;               ///< key mask: empty, or CV_8UC1 with n for object n

  [[nodiscard]] bool empty() const { return on.empty() && off.empty() && masks.empty(); }
};

/// Annotations of a clip, by time.
class AnnotationTrack {
 public:
  /// Copies the points of `settings`.
  explicit AnnotationTrack(const VisionSettings& settings);

  /// Returns the points of the clip's first frame, without a key mask.
  [[nodiscard]] const Annotation& atStart() const { return start_; }
  /// Returns the annotations of the present frame of `frames`: its key mask, and the points nearest
  /// to it in time but not nearer to the frame before.
  [[nodiscard]] Annotation annotationAt(const FramePair& frames) const;
  /// Returns whether the author marked an object after the first frame.
  [[nodiscard]] bool pointsLater() const { return !on_.empty(); }
  /// Returns whether points annotate a frame after the present one. Key masks of later frames are
  /// unknown.
  [[nodiscard]] bool hasLaterAnnotation(const FramePair& frames) const;

 private:
  Annotation start_;
  std::vector<AuthorPoint> on_;  // points of later frames
  std::vector<AuthorPoint> off_;
};

/// Returns the mask (0/255, size of `view`) of the pixels connected to `at` whose colours resemble
/// those of a disc of `radius_px` around it.
cv::Mat connectedTo(const GraphRoi& view, const cv::Point& at, int radius_px);

/// Adds the colours of the region at `point` (px of the picture), connected in colour and space, to
/// `colors`. Ignores a region narrower than 25 mm.
void addNegativeSample(const FrameContext& scene, const cv::Point& point, NegativeColors& colors);

}  // namespace hapticast::server
