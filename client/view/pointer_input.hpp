// SPDX-License-Identifier: MIT
// The pointer over the picture as input: it sets the target of the HIP. The wheel sets the depth.
// Thread: main.
#pragma once

#include <optional>

#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/view/painter.hpp"

namespace hapticast::client {

/// Returns true if the loop had a frame in the tick of `report`. The report then has the mapping of
/// the stream's workspace.
[[nodiscard]] inline bool isMapped(const TickReport& report) {
  return report.lookup != Lookup::kEmpty;
}

/// Converts pointer and wheel to the target of the HIP.
class PointerInput {
 public:
  /// Distance of the start position above the highest possible relief (the depth of the workspace),
  /// nominal mm. The value is a choice.
  static constexpr double kAboveRelief_mm = 5.0;
  /// Smallest z that the user can set, nominal mm: behind the picture's plane.
  static constexpr double kFarthest_mm = -5.0;

  /// Records that the pointer is at `point` over the picture, px of the window.
  void point(const Vec2& point) { waiting_ = point; }
  /// Moves `target` to the recorded point, in x and y. Does so only if `report` is mapped, and if
  /// `place` is that of a picture of the stream (`has_picture`). Otherwise the point stays
  /// recorded. The first target has the z of the start position, kAboveRelief_mm above the highest
  /// possible relief of the stream in `place`.
  void update(const TickReport& report, const ScenePlace& place, bool has_picture,
              PointerTarget& target);

  /// Moves `target` into the picture by `by_mm` (nominal), or out of it if the value is negative.
  /// Does nothing before the first target, or if `by_mm` is not finite.
  static void press(double by_mm, PointerTarget& target);
  /// Moves `target` by 1 mm for each notch of the wheel: out of the picture for positive `notches`.
  /// A touchpad reports fractions of a notch.
  static void turnWheel(double notches, PointerTarget& target);
  /// Moves `target` back to the z of the start position, above the picture.
  static void lift(PointerTarget& target);

 private:
  std::optional<Vec2> waiting_;
};

}  // namespace hapticast::client
