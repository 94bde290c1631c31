// SPDX-License-Identifier: MIT
// Who estimates depth from single pictures finds its scale and shift anew in each: all of a scene
// hops. What rests in the background tells by how much. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// The scale and shift that carry a frame's depth back to what it was: in 1/z of metric depth, in
/// working depth of 8-bit levels.
struct ScaleShift {
  double scale = 1.0;
  double shift = 0.0;
  [[nodiscard]] bool none() const { return scale == 1.0 && shift == 0.0; }
};

class DepthScaleAlignment {
 public:
  explicit DepthScaleAlignment(DepthKind kind) : inverse_(kind == DepthKind::kMetric) {}

  /// Working depth as it would be if its scale and shift had stayed; `depth` itself unless the
  /// source has shown that it hops, or while the camera moves. `gray`: CV_8UC1. `objects`: 0 / 255,
  /// what is no background; may be empty.
  cv::Mat steady(const cv::Mat& depth, const cv::Mat& gray, const cv::Mat& objects);
  /// Whether the source's depth hops.
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
  int hops_ = 0;         // to and fro
  double last_hop_ = 0;  // of all that rests, share
  int frame_ = 0;
  cv::Mat depth_;  // CV_32FC1, every kEvery_px: what rests is as deep as this; 0: not known
  cv::Mat gray_;   // CV_32FC1, likewise: as bright
  cv::Mat age_;    // CV_32FC1, frames
};

}  // namespace hapticast::server
