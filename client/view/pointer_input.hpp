// SPDX-License-Identifier: MIT
// The pointer over the picture as input: it sets the target of the HIP. The wheel sets the depth.
// Thread: main.
#pragma once

#include <optional>

#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/view/painter.hpp"

namespace hapticast::client {

/// Returns true if `report` belongs to a tick with the stream's mapping: the loop has a frame.
[[nodiscard]] inline bool isMapped(const TickReport& report) {
  return report.lookup != Lookup::kEmpty;
}

/// Converts pointer and wheel to the target of the HIP.
class PointerInput {
 public:
  /// Height of the start above the highest possible relief, which the depth of the workspace
  /// limits; nominal mm. The value is a choice.
  static constexpr double kAboveRelief_mm = 5.0;
  /// Farthest depth behind the picture, nominal mm.
  static constexpr double kFarthest_mm = -5.0;

  /// Records that the pointer is at `point` over the picture, px of the window.
  void point(const Vec2& point) { waiting_ = point; }
  /// Moves `target` to the recorded point. Before the first mapped tick, or while `place` has no
  /// picture of the stream (`has_picture`), the point waits. The first target is at the depth of
  /// the start, kAboveRelief_mm above the highest possible relief of the stream in `place`.
  void update(const TickReport& report, const ScenePlace& place, bool has_picture,
              PointerTarget& target);

  /// Moves `target` into the picture by `by_mm` (nominal), or out of it if the value is negative.
  /// Does nothing before the first target, or if `by_mm` is not finite.
  static void press(double by_mm, PointerTarget& target);
  /// Moves `target` by a turn of the wheel: out of the picture for positive `notches`. A touchpad
  /// turns by fractions of a notch.
  static void turnWheel(double notches, PointerTarget& target);
  /// Moves `target` back to the depth of the start, above the picture.
  static void lift(PointerTarget& target);

 private:
  std::optional<Vec2> waiting_;
};

}  // namespace hapticast::client
