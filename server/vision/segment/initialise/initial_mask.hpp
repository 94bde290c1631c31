// SPDX-License-Identifier: MIT
// Initial mask of an object: connected components in depth without supporting planes, then GrabCut
// by colour (Rother, Kolmogorov and Blake 2004).
// Runs once for each object, up to 0.3 s. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Returns labels (CV_32S, 0: none) of connected components in depth. 4-neighbours connect if their
/// step is at most DepthNoise::step_mm.
/// Holes up to 24 px are interpolated if both sides agree. Pixels of `excluded` (0/255) have no
/// label.
cv::Mat depthComponents(const cv::Mat& depth, const cv::Mat& excluded, const DepthNoise& noise);

/// Returns the median of the measured depths where `mask` is not 0, of every `step`-th pixel and
/// row, mm. 0 if none is measured.
double medianDepth(const cv::Mat& depth, const cv::Mat& mask, int step);

/// Returns whether `mask` hardly touches the picture's border.
bool clearOfBorder(const cv::Mat& mask);

/// Returns the nearest compact component (0/255), empty if there is none. Compact: 0.6 to 30 % of
/// the picture, at least 35 % of its box, clear of the picture's border, enough texture to track.
cv::Mat nearestCompact(const FrameImages& images, const cv::Mat& labels);

/// Object at a point: its first mask (0/255), or the cause if there is none. `planes`: planes of
/// the scene without those through the point, supports marked.
struct ObjectStart {
  cv::Mat mask;
  const char* why_not = nullptr;
  std::vector<Plane> planes;
};
/// Finds the object at `point`. A plane through the point may be a side of the object, unless it
/// covers a fifth of the picture: then there is no object.
ObjectStart findObject(const cv::Mat& depth, const cv::Point& point, const DepthNoise& noise,
                       std::vector<Plane> planes);

/// Refines `mask` by GrabCut at half size or less. Returns `mask` itself if the result has less
/// than 0.4 or more than 2.5 times its area (0.1 with `not_points`).
/// `object_point` lies on the object. A disc of 10 px around each of `not_points` is certain
/// background. Pixels nearer to one of them than to `object_point` are probable background.
cv::Mat cutByColor(const FrameImages& images, const cv::Mat& mask, const std::vector<Plane>& planes,
                   const cv::Point& object_point, const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
