// SPDX-License-Identifier: MIT
// What the author says of which frame: points (--object and --not, with their times) and drawn
// masks. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/graph_roi.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

inline constexpr int kPoint_px = 5;  ///< radius of what a person means by a point; chosen

/// The author's word on one frame.
struct Annotation {
  std::vector<cv::Point> on;   ///< is the object
  std::vector<cv::Point> off;  ///< is none
  cv::Mat masks;               ///< empty, or CV_8UC1 with n for object n

  [[nodiscard]] bool empty() const { return on.empty() && off.empty() && masks.empty(); }
};

class AnnotationTrack {
 public:
  explicit AnnotationTrack(const VisionSettings& settings);

  /// What is said of the clip's first frame, but for a drawn mask.
  [[nodiscard]] const Annotation& atStart() const { return start_; }
  /// What is said of this frame of `frames`: the one next in time to a point, and none before it.
  [[nodiscard]] Annotation annotationAt(const FramePair& frames) const;
  /// Whether an object is pointed at after the first frame.
  [[nodiscard]] bool pointsLater() const { return !on_.empty(); }
  /// Whether anything is said of a frame after this one; of drawn masks nobody knows.
  [[nodiscard]] bool hasLaterAnnotation(const FramePair& frames) const;

 private:
  Annotation start_;
  std::vector<AuthorPoint> on_;  // of later frames
  std::vector<AuthorPoint> off_;
};

/// The pixels of the view that are joined to `at` by colours like those in a disc around it, 255.
cv::Mat connectedTo(const GraphRoi& view, const cv::Point& at, int radius_px);

/// Adds the colours of what is at `point` of the picture, and joined to it in colour and space.
void addNegativeSample(const FrameContext& scene, const cv::Point& point, NegativeColors& colors);

}  // namespace hapticast::server
