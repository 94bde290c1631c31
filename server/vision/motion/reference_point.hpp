// SPDX-License-Identifier: MIT
// Where the middle of a body is, from what is seen of its surface: the point that its motion is
// told of, because the visible surface of a body that turns or nears moves otherwise than the body
// does. Thread: any.
#pragma once

#include <Eigen/Core>

#include "server/source/camera_model.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

struct BodyCentre {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  ///< camera frame
  bool sphere = false;  ///< the centre of a sphere that fits; else of an ellipsoid or blob
};

/// A sphere only where outline, fit and radius all say so; else the centre of the ellipsoid that
/// fits outline and depths, or the outline's centroid as far behind the visible surface as its
/// depth range tells (a flat thing: on it). `surface.depth` in mm; without any depth in it the
/// position is 0.
BodyCentre computeCentre(const Surface& surface, const CameraModel& camera);

}  // namespace hapticast::server
