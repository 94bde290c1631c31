// SPDX-License-Identifier: MIT
// Motion in cells of kGridCell_px, by Lucas-Kanade on a lattice over the object and a 2-D median:
// the thesis's dense flow, or what a rigid motion leaves unexplained of an object that deforms.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Motion from the last frame to this one in cells over the object's box: px, px and mm of working
/// depth per frame. Empty where it was not measured.
struct CellFlow {
  int columns = 0;
  int rows = 0;
  double interval_s = 0.0;  ///< since the last one
  cv::Mat step;             ///< CV_32FC3, rows x columns; shared with copies, never written to

  /// Cells as many, in which nothing moves; none stay none.
  [[nodiscard]] CellFlow atRest() const;
};

/// `kLk`: x-y only; `kDepth`: z only; `kAuto`: both. `last_mask`, `before`: the object in the last
/// frame.
CellFlow cellFlow(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
                  const Surface& before, const Surface& now, MotionMode mode);

/// Where a point of the surface went by the rigid motion: px, px (centres at whole numbers) and mm.
using PredictedMotion = std::function<cv::Vec3d(const cv::Point2f& at_px, double depth_mm)>;

/// What `explained` leaves over, px, px and mm of working depth per frame; 0 where nothing was
/// measured.
CellFlow residualFlow(const cv::Mat& last_gray, const cv::Mat& gray, const Surface& before,
                      const Surface& now, const PredictedMotion& explained);

/// The grid of frame `at` from the flows of the frames around it (those of other sizes are matched
/// by position in the box): velocity is the mean of the steps into and out of the frame,
/// acceleration the change of mean velocity from the steps before to those after. `mm_per_step`:
/// nominal mm per px right, px down and mm of working depth.
std::shared_ptr<const MotionGrid> makeMotionGrid(const std::vector<const CellFlow*>& flows,
                                                 std::size_t at, const Vec3& mm_per_step);

}  // namespace hapticast::server
