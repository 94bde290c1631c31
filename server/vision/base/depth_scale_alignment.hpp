// SPDX-License-Identifier: MIT
// Scale-and-shift alignment of monocular depth: an estimator that works on single pictures scales
// and shifts each frame differently, so the whole scene hops.
// Resting background samples measure the hop by least median of squares (Rousseeuw 1984) and
// reweighted least squares with Tukey's biweight (Beaton and Tukey 1974). The hop is then undone.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Scale and shift that map a frame's depth onto the depth before: of 1/z for metric depth, of
/// working depth for 8-bit levels.
struct ScaleShift {
  double scale = 1.0;
  double shift = 0.0;
  [[nodiscard]] bool none() const { return scale == 1.0 && shift == 0.0; }
};

/// Aligns the depth of successive frames of one scene.
class DepthScaleAlignment {
 public:
  explicit DepthScaleAlignment(DepthKind kind) : inverse_(kind == DepthKind::kMetric) {}

  /// Returns working depth (CV_32FC1, mm) with the scale and shift of the frames before.
  /// Returns `depth` itself before the source has shown hops, and while the camera moves. `gray`:
  /// CV_8UC1. `objects`: CV_8UC1, 0/255, non-background, may be empty. All have one size.
  cv::Mat steady(const cv::Mat& depth, const cv::Mat& gray, const cv::Mat& objects);
  /// Returns whether the source has shown hops.
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

  bool inverse_;
  bool shown_ = false;
  bool camera_rests_ = false;
  int hops_ = 0;         // alternating
  double last_hop_ = 0;  // of all resting samples, as a share of the depth
  int frame_ = 0;
  cv::Mat depth_;  // CV_32FC1, every kEvery_px: mean depth of resting samples, mm; 0: not measured
  cv::Mat gray_;   // CV_32FC1, every kEvery_px: mean brightness of resting samples
  cv::Mat age_;    // CV_32FC1, frames at rest
};

}  // namespace hapticast::server
