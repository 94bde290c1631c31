// SPDX-License-Identifier: MIT
// Initial mask of an object: finds the connected component of depth at a point, without the pixels
// of supporting planes. GrabCut then refines it by colour (Rother, Kolmogorov and Blake 2004). Runs
// once for each object and lasts up to 0.3 s. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Labels the connected components of depth, and returns the image of labels (CV_32S, 0: no
/// component). Neighbouring pixels are connected if their depths differ by at most
/// DepthNoise::step_mm. Holes up to 24 px wide are interpolated if the depths on both sides agree.
/// Pixels of `excluded` (0/255) have no label.
cv::Mat depthComponents(const cv::Mat& depth, const cv::Mat& excluded, const DepthNoise& noise);

/// Returns the number of pixels of `mask` at the picture's border. It counts corners twice.
int countBorderPixels(const cv::Mat& mask);

/// Returns whether `mask` has no pixels, or only few, at the picture's border.
bool clearOfBorder(const cv::Mat& mask);

/// Object at a point, with its first mask (0/255). If there is no object, `mask` is empty and
/// `why_not` is the cause. `planes` are the planes of the scene without those through the point;
/// supporting planes are marked.
struct ObjectStart {
  cv::Mat mask;
  const char* why_not = nullptr;
  bool too_small = false;  ///< the component at the point has too few pixels
  std::vector<Plane> planes;
};
/// Returns the object at `point`. A plane through the point counts as a side of the object, unless
/// the plane covers a fifth of the picture or more. Then it is background, and the mask is empty.
ObjectStart findObject(const cv::Mat& depth, const cv::Point& point, const DepthNoise& noise,
                       std::vector<Plane> planes);

/// Returns `mask`, refined by GrabCut at half size or less. Returns `mask` itself if the refined
/// mask has less than 0.4 or more than 2.5 times its area. If there are `not_points`, the lower
/// limit is 0.1. `object_point` lies on the object. A disc of 10 px around each of `not_points` is
/// certain background. Pixels nearer to one of them than to `object_point` are probable background.
cv::Mat cutByColor(const FrameImages& images, const cv::Mat& mask, const std::vector<Plane>& planes,
                   const cv::Point& object_point, const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
