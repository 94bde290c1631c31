// SPDX-License-Identifier: MIT
// The things that hands of the scenes hold, in a frame with y up and z to the viewer. Thread: any;
// values.
#pragma once

#include "tests/scenes/held/path.hpp"
#include "tests/scenes/held/solid.hpp"

namespace hapticast::evaluate::held {

enum class Kind : std::uint8_t { kMug, kBear, kBall, kBox, kTube, kBottle, kTablet };

/// A kind of thing in its size and colours.
struct Object {
  Kind kind = Kind::kMug;
  double size = 1.0;      ///< of its usual one
  std::size_t paint = 0;  ///< its own and, after it in the scene's paints, those of its details
  Ramp bent;              ///< kBall: share it is squeezed by along x; kTube: its curvature, 1/mm
  Path path;              ///< in the frame that it is drawn in

  [[nodiscard]] Thing at(double t) const;
  [[nodiscard]] bool deforms() const { return bent.changes(); }
  /// Its surface's point that is at `at_mm` at t: how it moves, squeezing and bending with it.
  [[nodiscard]] Vec3 velocityAt(const Vec3& at_mm, double t) const;
  /// Where a point moves to with the thing, given in its frame when it was neither squeezed nor
  /// bent.
  [[nodiscard]] Vec3 placed(const Vec3& unbent_mm, double t) const;
  /// How something that sits on the thing there is turned by its bending.
  [[nodiscard]] Mat3 turned(const Vec3& unbent_mm, double t) const;
};

/// How many paints a kind uses from Object::paint on.
inline constexpr std::size_t kObjectPaints = 4;

}  // namespace hapticast::evaluate::held
