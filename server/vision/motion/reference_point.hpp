// SPDX-License-Identifier: MIT
// Reference point: estimates the centre of a body from its visible surface. It fits a sphere or an
// ellipsoid; if both fail, it estimates the centre from the spread of the depths. Motion refers to
// this centre, because the visible surface of a turning or approaching body moves differently from
// the body. Thread: any.
#pragma once

#include <Eigen/Core>

#include "server/source/camera_model.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Estimated centre of a body.
struct BodyCentre {
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();  ///< position in the camera frame, mm
  bool sphere = false;  ///< true: centre of a fitted sphere; false: of an ellipsoid, or an estimate
};

/// Returns the centre of the body whose visible surface is `surface` (depth in mm). The position is
/// 0 if the surface has too few measured depths. The body counts as a sphere if its outline is
/// round and a sphere of matching radius fits the depths well. Otherwise the result is the centre
/// of the ellipsoid that fits outline and depths. If that fit fails too, the result is the
/// outline's centroid, moved from the mean depth away from the camera. It is moved farther if the
/// depths spread more, and not at all for a flat object.
BodyCentre computeCentre(const Surface& surface, const CameraModel& camera);

}  // namespace hapticast::server
