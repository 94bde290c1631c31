// SPDX-License-Identifier: MIT
// From the motion of single points to that of cells: a robust plane about each cell's middle.
// Thread: any; values.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// What the rigid motion leaves of the way of one point.
struct LeftStep {
  cv::Point2f at_px;           ///< in the box, pixel centres at whole numbers
  std::array<double, 3> step;  ///< px, px and mm of working depth
};

/// CV_32FC3, rows x columns: the steps at the middles of cells of kGridCell_px. Beyond the points
/// it goes on as the cells beside it, for a viewer reads between the cells; 0 where there are none.
cv::Mat cellsFittedTo(const std::vector<LeftStep>& left, int columns, int rows);

}  // namespace hapticast::server
