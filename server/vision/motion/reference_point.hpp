// SPDX-License-Identifier: MIT
// Reference point: estimates the centre of a body from its visible surface by a sphere fit, an
// ellipsoid fit or a heuristic.
// Motion refers to this centre, because the visible surface of a turning or approaching body moves
// differently from the body. Thread: any.
#pragma once

#include <Eigen/Core>

#include "server/source/camera_model.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Estimated centre of a body.
struct BodyCentre {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  ///< camera frame
  bool sphere = false;  ///< centre of a fitted sphere; false: of an ellipsoid or another body
};

/// Returns the centre of the body behind `surface` (depth in mm); position 0 if it has too little
/// depth.
/// A sphere needs a round outline, a good fit and a matching radius. Otherwise it is the centre of
/// the ellipsoid that fits outline and depths.
/// If that fit fails too, it is the outline's centroid, set behind the mean depth in proportion to
/// the spread of the depths (0 for a flat object).
BodyCentre computeCentre(const Surface& surface, const CameraModel& camera);

}  // namespace hapticast::server
