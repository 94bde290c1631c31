// SPDX-License-Identifier: MIT
// The motion of a thing and its hands, in the table's frame (x right, y up, z to the
// viewer). Thread: one.
#pragma once

#include "tests/scenes/held/stage.hpp"

namespace hapticast::evaluate::held {

/// A stage with one thing on it that moves, and grips on it.
class Play : public Stage {
 public:
  using Stage::Stage;

  // The object stands or floats there, turned about the upright axis.
  void object(Kind kind, const Vec3& at_mm, double yaw_rad, double size = 1.0) {
    scene.object.kind = kind;
    scene.object.size = size;
    scene.object.paint = addPaintsOf(kind);
    way_ = Path({Eigen::AngleAxisd(mirror * yaw_rad, Vec3::UnitY()).toRotationMatrix(), at_mm});
  }
  Path& way() { return way_; }
  void swing(const Ease& when, const Vec3& axis, double by_rad) {
    // Seen in a mirror an axis turns the other way about, but for its part along x.
    way_.turn(when, {axis.x(), mirror * axis.y(), mirror * axis.z()}, by_rad);
  }

  // A grip from `side` of the object (table's frame at the start), the palm that far from its
  // middle.
  Pose gripFrom(const Vec3& side, double distance_mm, const Vec3& fingers) const {
    const Vec3 n = side.normalized();
    const Vec3 f = (fingers - fingers.dot(n) * n).normalized();
    const Pose in_table =
        handAt(way_.at(0.0).pose.at_mm + (distance_mm + kPalm_mm) * n - kReach_mm * f, -n, f);
    const Pose begin = way_.at(0.0).pose;
    return {begin.turn.transpose() * in_table.turn, begin.in(in_table.at_mm)};
  }

  // The object's way is complete: it and the hands are placed.
  void finishObject() { scene.object.path = way_.in(to_camera); }
  void close(HandScript& hand, const Pose& grip) {
    Thing thing = scene.object.at(0.0);
    hand.grip = closedOn(thing, hand.look, grip);
  }
  [[nodiscard]] Pose inScene(const Pose& in_table) const { return to_camera * in_table; }
  /// The pose of a grip at a moment, moved off by `away_mm`.
  [[nodiscard]] Station off(double time_s, const Pose& grip, double at_s,
                            const Vec3& away_mm) const {
    Pose pose = way_.at(at_s).pose * grip;
    pose.at_mm += away_mm;
    return {time_s, Station::On::kScene, inScene(pose), 0.0, Vec3::Zero()};
  }
  [[nodiscard]] static Station on(double time_s, const Pose& grip, double closed,
                                  const Vec3& anchor = Vec3::Zero()) {
    return {time_s, Station::On::kObject, grip, closed, anchor};
  }

 private:
  static constexpr double kPalm_mm = 13.0;   // from the middle of the palm to its skin
  static constexpr double kReach_mm = 24.0;  // the thing lies this far towards the fingers

  Path way_;
};

}  // namespace hapticast::evaluate::held
