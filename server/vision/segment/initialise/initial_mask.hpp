// SPDX-License-Identifier: MIT
// The careful start of an object: what hangs together in depth, without the planes things stand on,
// then GrabCut by colour (Rother, Kolmogorov and Blake 2004). Done once per object, up to 0.3 s.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Labels (CV_32S, 0 = none) of what hangs together in depth: 4-neighbours within
/// DepthNoise::step_mm, holes up to 24 px bridged where both sides agree, pixels of `excluded` (0 /
/// 255) left out.
cv::Mat depthComponents(const cv::Mat& depth, const cv::Mat& excluded, const DepthNoise& noise);

/// Median of the known depths where `mask` is not 0, of every `step`-th pixel and row; 0: nothing
/// is known there.
double medianDepth(const cv::Mat& depth, const cv::Mat& mask, int step);

/// Whether hardly any of `mask` lies on the picture's border.
bool clearOfBorder(const cv::Mat& mask);

/// The nearest component that is compact: 0.6 to 30 % of the picture, at least 35 % of its box,
/// clear of the picture's border, with texture enough to be followed. 0 / 255; empty when there is
/// none.
cv::Mat nearestCompact(const FrameImages& images, const cv::Mat& labels);

/// What is under a point: an object's first mask (0 / 255), or why there is none; and the planes of
/// the scene without those that go through the point, supports marked.
struct ObjectStart {
  cv::Mat mask;
  const char* why_not = nullptr;
  std::vector<Plane> planes;
};
/// A plane through the point is not taken for an object's side where it is a fifth of the picture:
/// then the point is on nothing.
ObjectStart findObject(const cv::Mat& depth, const cv::Point& point, const DepthNoise& noise,
                       std::vector<Plane> planes);

/// `mask` settled by colour: GrabCut at half size or less; the mask itself where that changes its
/// area to outside 0.4 .. 2.5 times. `object_point` is on it; around each of `not_points` a disc of
/// 10 px surely is not, and what is nearer to one of them than to the object's point (then down to
/// 0.1 times the area may be left) is rather not.
cv::Mat cutByColor(const FrameImages& images, const cv::Mat& mask, const std::vector<Plane>& planes,
                   const cv::Point& object_point, const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
