// SPDX-License-Identifier: MIT
// The pinhole camera and the depth range of a clip. Plain values without OpenCV, so that the truth
// of the synthetic scenes can be used anywhere. Thread: any.
#pragma once

namespace hapticast::server {

/// Depths that are mapped to heights: far to 0, near to the workspace's depth (30 mm).
struct DepthRange {
  double near_mm = 0.0;
  double far_mm = 0.0;
};

/// Pinhole: u = fx X/Z + cx, v = fy Y/Z + cy with X right, Y down, Z forward. In the image frame of
/// common/geometry, where the centre of pixel (i, j) is (i + 0.5, j + 0.5); so cx, cy are half a
/// pixel larger than in OpenCV's convention.
struct CameraModel {
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
};

}  // namespace hapticast::server
