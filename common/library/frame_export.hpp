// SPDX-License-Identifier: MIT
// Converts frames of the programs to those of the library (hapticast/frame.hpp). Thread: at most
// one at a time.
#pragma once

#include <map>
#include <memory>

#include "common/haptic_frame.hpp"
#include "common/include/hapticast/frame.hpp"

namespace hapticast {

/// Returns the properties that `description` states.
[[nodiscard]] StreamInfo exportInfo(const StreamDescription& description);
/// Returns the heights of `relief`.
[[nodiscard]] std::shared_ptr<const HeightMap> exportHeights(const Relief& relief);
/// Returns a copy of `object`, except its heights.
template <class Shape>
[[nodiscard]] Object exportObject(const ObjectOf<Shape>& object) {
  Object to;
  to.id = object.id;
  to.layer = object.layer;
  to.position_mm = object.motion.position_mm;
  to.velocity_mm_s = object.motion.velocity_mm_s;
  to.acceleration_mm_s2 = object.motion.acceleration_mm_s2;
  to.angle_rad = object.motion.angle_rad;
  to.angular_velocity_rad_s = object.motion.angular_velocity_rad_s;
  to.quality = object.motion.quality;
  to.visible_fraction = object.motion.visible_fraction;
  if (object.grid) {
    to.cells = std::make_shared<const Object::CellMotion>(
        Object::CellMotion{object.grid->columns, object.grid->rows, object.grid->velocity_mm_s,
                           object.grid->acceleration_mm_s2});
  }
  to.impacts.reserve(object.impacts.size());
  for (const Impact& each : object.impacts)
    to.impacts.push_back({toSeconds(each.time), each.delta_velocity_mm_s});
  const Material& material = object.material;
  to.material = {material.stiffness_N_mm,   material.damping_Ns_m, material.static_friction,
                 material.dynamic_friction, material.texture_K_mm, material.mass_kg};
  return to;
}

/// Converts the frames of one stream, in their order. An object whose Relief is that of the frame
/// before has the HeightMap of the frame before.
class FrameExporter {
 public:
  [[nodiscard]] Frame convert(const HapticFrame& frame);

 private:
  struct Known {
    std::shared_ptr<const Relief> relief;
    std::shared_ptr<const HeightMap> heights;
  };
  std::map<ObjectKey, Known> known_;  // of the frame before
};

}  // namespace hapticast
