// SPDX-License-Identifier: MIT
// Where the scenes of held things take place: a table, what lies about, a person, a wall; drawn
// from a seed. Thread: one.
#pragma once

#include "tests/scenes/held/draw.hpp"
#include "tests/scenes/held/scene.hpp"

namespace hapticast::evaluate::held {

/// Scenes are in the table's frame: x right, y up, z to the viewer, origin on the table.
struct StagePlan {
  double pitch_rad = 0.45;     ///< how far the camera looks down
  double distance_mm = 640.0;  ///< from it to the point above the origin that it looks at
  double looks_at_mm = 60.0;   ///< above the table
  bool person = true;          ///< sits behind the table
  bool clutter = true;
};

/// Builds a scene: paints are drawn, the room is set up; who uses it adds object, hands and props.
class Stage {
 public:
  Stage(std::string name, const StagePlan& plan, std::uint64_t seed);

  Draw draw;
  Scene scene;
  Pose to_camera;                 ///< table to camera
  Vec3 person_mm = Vec3::Zero();  ///< the middle of the person, in the table's frame
  double mirror = 1.0;            ///< -1: left and right are exchanged
  std::size_t skin = 0, fingertip = 0, sleeve = 0, shirt = 0;  ///< paints of this person

  /// A place or direction of the unmirrored scene.
  [[nodiscard]] Vec3 at(double x, double y, double z) const { return {mirror * x, y, z}; }
  std::size_t add(const Paint& paint);
  /// Four paints of a kind of object, drawn.
  std::size_t addPaintsOf(Kind kind);
  /// A hand whose elbow is there (table's frame); right or left as seen in the unmirrored scene.
  HandScript hand(std::uint8_t id, bool right, const Vec3& elbow_mm);

 private:
  void drawLight();
  void drawPerson();
  void setTable(const StagePlan& plan);
  void setClutter();
  void setPerson();
  void place(Thing thing);
};

/// Colours as people name them: 0..255 of a screen, red, green, blue.
Color screen(double red, double green, double blue);
/// A colour of things that are sold: often strong, sometimes grey.
Color anyColor(Draw& draw);

}  // namespace hapticast::evaluate::held
