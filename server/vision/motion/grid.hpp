// SPDX-License-Identifier: MIT
// Measures the motion of an object in cells of kGridCell_px. Lucas-Kanade tracks points on a
// lattice over the object. Each cell has the median of its tracks, and a 3 x 3 median filter
// removes outliers. The result is the whole motion (the thesis's dense flow), or the residual
// motion of a deforming object: its motion minus its rigid motion. Thread: the one that runs
// Vision.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Motion of each cell of an object's box from the last frame to this frame: px to the right, px
/// down and mm of depth. Empty if it was not measured.
struct CellFlow {
  int columns = 0;
  int rows = 0;
  double interval_s = 0.0;  ///< time since the last frame, s
  cv::Mat step;  ///< motion of each cell, CV_32FC3, rows x columns; copies share it; read-only

  /// Returns a flow with the same cells, all without motion. Returns an empty flow if this one is
  /// empty.
  [[nodiscard]] CellFlow atRest() const;
};

/// Measures the whole motion of an object in cells. `mode`: kLk measures x and y only, kDepth
/// measures z only, and kAuto measures all three. `last_mask` (CV_8UC1, 0/255, size of the image)
/// and `before` belong to the last frame.
CellFlow cellFlow(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
                  const Surface& before, const Surface& now, MotionMode mode);

/// Function that returns how a rigid motion displaces a surface point: px to the right, px down and
/// mm of depth. `at_px`: the point (pixel centres at whole numbers). `depth_mm`: its depth.
using PredictedMotion = std::function<cv::Vec3d(const cv::Point2f& at_px, double depth_mm)>;

/// Measures the residual motion in cells: the measured motion minus the motion that `explained`
/// predicts. Cells without a measurement have motion 0. If `now.reduction` is above 1, it measures
/// in pictures that are downsampled by this factor, and interpolates the motion of the cells.
CellFlow residualFlow(const cv::Mat& last_gray, const cv::Mat& gray, const Surface& before,
                      const Surface& now, const PredictedMotion& explained);

/// Input of measureCells(). Its images are shared and read-only.
struct CellInput {
  /// kNone: nothing is measured. kRest: the object rests. kWhole and kResidual: see cellFlow() and
  /// residualFlow().
  enum class Kind { kNone, kRest, kWhole, kResidual };

  Kind kind = Kind::kNone;
  double interval_s = 0.0;      ///< time since the last frame, s
  cv::Mat last_gray;            ///< picture of the last frame, CV_8UC1
  cv::Mat gray;                 ///< picture of this frame, CV_8UC1
  cv::Mat last_mask;            ///< mask of the last frame, CV_8UC1, 0/255; only for kWhole
  Surface before;               ///< surface of the last frame
  PredictedMotion explained{};  ///< motion that is no residual; only for kResidual
};

/// Returns the motion in cells for `input`. `now`: surface of this frame. `last`: result of the
/// frame before. `mode`: mode of cellFlow().
CellFlow measureCells(const CellInput& input, const Surface& now, const CellFlow& last,
                      MotionMode mode);

/// Returns the motion grid of one frame. flows[at] is the motion from the frame before it to this
/// frame. `flows` also has the motions to the frames around it, in order. Returns null if flows[at]
/// is empty. The velocity is the mean of the motions to the frame and from it to the next one. The
/// acceleration is the mean velocity after the frame minus that before it, divided by the time
/// between them. If flows have different sizes, cells correspond by their relative position in the
/// box. `mm_per_step`: nominal mm for each px to the right, px down and mm of depth.
std::shared_ptr<const MotionGrid> makeMotionGrid(const std::vector<const CellFlow*>& flows,
                                                 std::size_t at, const Vec3& mm_per_step);

}  // namespace hapticast::server
