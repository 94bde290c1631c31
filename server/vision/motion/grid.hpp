// SPDX-License-Identifier: MIT
// Dense motion in cells of kGridCell_px: Lucas-Kanade tracks on a lattice over the object, then a
// median in each cell and a 3 x 3 median filter.
// It measures the thesis's dense flow, or the residual of the rigid motion of a deforming object.
// Thread: the one that runs Vision.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Motion from the last frame to this frame in cells over the object's box: px, px and mm of
/// working depth per frame. Empty if not measured.
struct CellFlow {
  int columns = 0;
  int rows = 0;
  double interval_s = 0.0;  ///< since the last frame
  cv::Mat step;             ///< CV_32FC3, rows x columns; shared by copies, read-only

  /// Returns a flow with the same cells, all at rest; empty if this flow is empty.
  [[nodiscard]] CellFlow atRest() const;
};

/// Measures the whole flow of an object. `kLk`: x-y only; `kDepth`: z only; `kAuto`: both.
/// `last_mask` (CV_8UC1, 0/255, image size) and `before` belong to the last frame.
CellFlow cellFlow(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
                  const Surface& before, const Surface& now, MotionMode mode);

/// Displacement of a surface point by the rigid motion: px, px and mm. `at_px`: centres at whole
/// numbers.
using PredictedMotion = std::function<cv::Vec3d(const cv::Point2f& at_px, double depth_mm)>;

/// Measures the residual flow, which `explained` does not predict: px, px and mm of working depth
/// per frame. Cells without a measurement are 0.
CellFlow residualFlow(const cv::Mat& last_gray, const cv::Mat& gray, const Surface& before,
                      const Surface& now, const PredictedMotion& explained);

/// Returns the grid of frame `at` from the flows of the frames around it. Flows of other sizes
/// match by relative position in the box. Null if the flow of `at` is empty.
/// Velocity is the mean of the steps into and out of the frame. Acceleration is the change of mean
/// velocity from the steps before to the steps after.
/// `mm_per_step`: nominal mm per px right, px down and mm of working depth.
std::shared_ptr<const MotionGrid> makeMotionGrid(const std::vector<const CellFlow*>& flows,
                                                 std::size_t at, const Vec3& mm_per_step);

}  // namespace hapticast::server
