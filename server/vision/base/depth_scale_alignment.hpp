// SPDX-License-Identifier: MIT
// Scale-and-shift alignment for depth from monocular depth estimation. An estimator scales and
// shifts each frame differently, so the depth of the whole scene jumps between frames (a hop). The
// class measures each hop at background pixels at rest, and corrects the depth by it. Least median
// of squares (Rousseeuw 1984) fits scale and shift. Reweighted least squares with Tukey's biweight
// (Beaton and Tukey 1974) refine the fit. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Scale and shift that map a frame's depth onto the depth of the frame before. For metric depth of
/// files and for inverse depth of a program they apply to 1/z. For all other depth they apply to
/// the working depth (frame_pair.hpp).
struct ScaleShift {
  double scale = 1.0;
  double shift = 0.0;
  [[nodiscard]] bool isNone() const { return scale == 1.0 && shift == 0.0; }
};

/// Removes the hops between the depths of successive frames of one scene.
class DepthScaleAlignment {
 public:
  /// Depth that a program estimates hops from the first frame on.
  explicit DepthScaleAlignment(DepthKind kind, EstimatedDepth estimated = EstimatedDepth::kNone)
      : inverse_(kind == DepthKind::kMetric &&
                 (estimated == EstimatedDepth::kNone || estimated == EstimatedDepth::kInverse)),
        shown_(estimated != EstimatedDepth::kNone) {}

  /// Returns `depth`, corrected to the scale and shift of the frames before. Returns `depth`
  /// unchanged while the camera moves, and until hops were detected. `depth`: working depth,
  /// CV_32FC1, mm. `gray`: CV_8UC1. `objects`: CV_8UC1, 255 on objects and 0 on the background; may
  /// be empty. All have one size. Call it once for each frame.
  cv::Mat steady(const cv::Mat& depth, const cv::Mat& gray, const cv::Mat& objects);
  /// Returns whether hops were detected. From then on steady() corrects them.
  [[nodiscard]] bool shown() const { return shown_; }

 private:
  struct Pair {
    double now, before;
  };
  [[nodiscard]] std::vector<Pair> restingPairs(const cv::Mat& depth, const cv::Mat& gray,
                                               const cv::Mat& objects);
  void judge(const std::vector<Pair>& pairs, const ScaleShift& hop);
  void remember(const cv::Mat& depth, const cv::Mat& gray, const ScaleShift& hop);
  [[nodiscard]] double toAligned(float depth_mm) const {
    return inverse_ ? 1e3 / double(depth_mm) : double(depth_mm);
  }

  bool inverse_;  // scale and shift apply to 1/z
  bool shown_;
  bool camera_rests_ = false;
  int hops_ = 0;         // hops so far that alternated in direction
  double last_hop_ = 0;  // last hop of all resting samples, as a share of the depth
  int frame_ = 0;
  cv::Mat depth_;  // of each sample, CV_32FC1: mean depth at rest, mm; 0: not measured
  cv::Mat gray_;   // of each sample, CV_32FC1: mean brightness at rest
  cv::Mat age_;    // frames for which each sample is at rest, CV_32FC1
};

}  // namespace hapticast::server
