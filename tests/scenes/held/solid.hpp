// SPDX-License-Identifier: MIT
// Solids given by a distance formula: what the scenes of held things are made of. A thing is
// several parts that flow into each other; where a ray meets it is the root of one formula, so that
// depth is exact. Thread: any; values.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast::evaluate::held {

using Mat3 = Eigen::Matrix3d;

/// A rigid placement: what is at p in the inner frame is at turn p + at_mm in the outer one.
struct Pose {
  Mat3 turn = Mat3::Identity();
  Vec3 at_mm = Vec3::Zero();

  [[nodiscard]] Vec3 out(const Vec3& inner_mm) const { return turn * inner_mm + at_mm; }
  [[nodiscard]] Vec3 in(const Vec3& outer_mm) const {
    return turn.transpose() * (outer_mm - at_mm);
  }
};
inline Pose operator*(const Pose& outer, const Pose& inner) {
  return {outer.turn * inner.turn, outer.out(inner.at_mm)};
}
/// A turn that takes y to `to`.
Mat3 turnOfY(const Vec3& to);

/// The kinds of parts, each about the origin of its own frame, y up; what `size_mm` means.
enum class Form : std::uint8_t {
  kRoundCone,  ///< from the origin along y: radius there, length, radius at the end
  kEllipsoid,  ///< semi-axes
  kBox,        ///< half edges
  kCylinder,   ///< radius, half height
  kMug,        ///< radius, half height, thickness of its wall; open at the top, handle at +x
  kTube,       ///< radius, half length along x, curvature (1/mm) towards y; round ends
};

struct Part {
  Form form = Form::kEllipsoid;
  Vec3 size_mm = Vec3::Zero();
  Pose pose;               ///< part to thing
  std::size_t paint = 0;   ///< of the scene's paints
  int group = 0;           ///< parts of one group flow together; groups stand next to each other
  double rounding_mm = 0;  ///< of edges (kBox, kCylinder)
  Vec3 squeeze = Vec3::Ones();  ///< what a kEllipsoid's axes were multiplied by
};

Part makePart(Form form, const Vec3& size_mm, const Vec3& at_mm, std::size_t paint, int group = 0);
/// A round cone between two places.
Part makeLimb(const Vec3& from_mm, const Vec3& to_mm, double radius_mm, double end_radius_mm,
              std::size_t paint, int group = 0);

struct Thing {
  std::uint8_t id = 0;  ///< what truth calls it
  std::vector<Part> parts;
  Pose pose;
  double blend_mm = 0.0;  ///< over how much parts flow into each other
  double fur_mm = 0.0;    ///< the surface is rough by this
};

/// Distance (a lower bound of it where fur or an ellipsoid make it one; its zero is exact) of a
/// point in the part's own frame.
double distanceTo_mm(const Part& part, const Vec3& at_mm);

/// Where a place of the part was when the part was neither squeezed nor bent: its paint sticks
/// there.
Vec3 textured(const Part& part, const Vec3& at_mm);

/// Which parts of a thing to look at; a set of their indices, in order.
using Parts = std::vector<std::uint8_t>;

/// Distance of a point in the thing's frame, of the parts in `among`, and the nearest of them.
struct Near {
  double distance_mm = 1e9;
  std::uint8_t part = 0;
};
Near nearest(const Thing& thing, const Parts& among, const Vec3& at_mm);
double distanceTo_mm(const Thing& thing, const Vec3& at_mm);
/// The outward normal there, in the thing's frame.
Vec3 normalAt(const Thing& thing, const Parts& among, const Vec3& at_mm);

/// A ball about the part, in the thing's frame, with room for what blend and fur add.
struct Ball {
  Vec3 centre_mm = Vec3::Zero();
  double radius_mm = 0.0;
};
Ball ballAround(const Thing& thing, const Part& part);

/// The middle line of a bent tube: where its place `along_mm` (from the middle) is, and the
/// direction across it, towards the bend.
struct TubePlace {
  Vec3 at_mm;
  Vec3 across;
};
TubePlace placeOnTube(double along_mm, double curvature);

}  // namespace hapticast::evaluate::held
