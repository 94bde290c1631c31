// SPDX-License-Identifier: MIT
// The tables of held scenes: a name, a sensor, a stage, and what happens on it. Thread: any.
#pragma once

#include <vector>

#include "tests/scenes/held/play.hpp"

namespace hapticast::evaluate::held {

/// One line for each scene.
struct Recipe {
  const char* name;
  DepthSense sense;  ///< in set 1; other sets draw it
  StagePlan plan;
  void (*play)(Play&);
  bool draws_as_before = false;  ///< thing, person and light of the line before
  bool reported_apart = false;   ///< has sums and goals of its own
  double noise = 1.0;            ///< of colour, over the usual one: more in low light
};

/// Cameras across the table, and from over it.
inline const StagePlan kAcross{0.42, 570.0, 75.0, true, true};
inline const StagePlan kOverhead{0.95, 560.0, 40.0, false, true};

/// Where the forearm of a hand comes from: over the viewer's side, to the right; and from the
/// person's.
inline Vec3 viewersElbow(const Play& play) { return play.at(300, 40, 420); }
inline Vec3 personsElbow(const Play& play) { return play.at(240, 60, -330); }
/// A hand of the person, its forearm from where the upper arm ends: on the right or left as seen in
/// the unmirrored scene. Both hands have the same kind of sleeve.
inline HandScript personsHand(Play& play, std::uint8_t id, bool on_right) {
  const Vec3 elbow = play.person_mm + play.at(on_right ? 235 : -235, 72, 112);
  HandScript hand = play.hand(id, !on_right, elbow);
  hand.elbow_follows = 0.1;
  if (!play.scene.hands.empty()) hand.look.has_sleeve = play.scene.hands.front().look.has_sleeve;
  return hand;
}
/// Adds a hand that holds the thing from the first frame to the last: closed by this share of its
/// grip, at a place of the unbent thing that it moves with.
inline void holdThroughout(Play& play, HandScript hand, const Pose& grip, double closed = 1.0,
                           const Vec3& anchor_mm = Vec3::Zero()) {
  play.close(hand, grip);
  hand.stations = {Play::on(0, grip, closed, anchor_mm), Play::on(9, grip, closed, anchor_mm)};
  play.scene.hands.push_back(hand);
  play.scene.held_at_start = true;
}

/// The scenes of `scripts.cpp`, `scripts_hard.cpp` and `scripts_last.cpp`. New ones come last: the
/// seed of a scene is its place.
const std::vector<Recipe>& firstRecipes();
const std::vector<Recipe>& hardRecipes();
const std::vector<Recipe>& lastRecipes();

}  // namespace hapticast::evaluate::held
