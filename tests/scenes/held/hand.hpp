// SPDX-License-Identifier: MIT
// A hand of round cones with its forearm: fingers close on a thing until they touch it. Thread:
// any; values.
#pragma once

#include <array>

#include "tests/scenes/held/solid.hpp"

namespace hapticast::evaluate::held {

/// In the hand's own frame: origin in the middle of the palm, z out of the palm, y along the
/// fingers, x to the thumb of a right hand.
struct HandLook {
  bool right = true;
  double scale = 1.0;
  std::size_t skin = 0;       ///< paints
  std::size_t fingertip = 0;  ///< with nails; a glove's own
  std::size_t sleeve = 0;
  bool has_sleeve = true;
  double sleeve_from = 0.3;  ///< of the forearm's length
};

/// How far each joint is bent, rad: thumb, index .. little finger, from the palm outwards.
using Curls = std::array<std::array<double, 3>, 5>;

/// A relaxed, open hand.
Curls openHand();
/// Between two.
Curls between(const Curls& a, const Curls& b, double share);

/// The hand at `pose`, its forearm reaching to `elbow_mm` (in the frame that `pose` leads to).
Thing makeHand(std::uint8_t id, const HandLook& look, const Pose& pose, const Curls& curls,
               const Vec3& elbow_mm);

/// The fingers closed about `thing` as far as it and they allow, with the palm at `on_thing` (hand
/// to thing).
Curls closedOn(const Thing& thing, const HandLook& look, const Pose& on_thing);

/// Thumb and index finger with their tips this far apart, and the place between them, in the
/// hand's frame.
struct Pinch {
  Curls curls{};
  Vec3 middle_mm = Vec3::Zero();
};
Pinch pinchOf(const HandLook& look, double thickness_mm);

/// A hand whose palm looks along `palm` and whose fingers point along `fingers`, as nearly as the
/// two are at a right angle.
Pose handAt(const Vec3& at_mm, const Vec3& palm, const Vec3& fingers);

}  // namespace hapticast::evaluate::held
