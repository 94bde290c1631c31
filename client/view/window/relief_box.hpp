// SPDX-License-Identifier: MIT
// Position of the box that shows the relief from the side. The user can move and close the box.
// Thread: any (no shared state).
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "client/view/painter.hpp"

namespace hapticast::client {

/// Part of the box under a point.
enum class BoxPart : std::uint8_t {
  kNone,   ///< beside the box
  kTitle,  ///< a drag moves the box
  kClose,  ///< a click closes the box
  kBody,   ///< a drag rotates the relief
};

/// The rectangle of the box. At first it is in the lower left corner of the picture.
class ReliefBox {
 public:
  static constexpr double kTitle_px = 22.0;  ///< height of the title, and width of its button

  /// Returns the rectangle over the picture at `place`, px of the window.
  [[nodiscard]] cv::Rect2d rect(const ScenePlace& place) const;
  /// Returns the part of the box under `point`.
  [[nodiscard]] BoxPart part(const ScenePlace& place, const Vec2& point) const;
  /// Moves the box by `by_px`. The box stays inside the picture.
  void move(const ScenePlace& place, const Vec2& by_px);

 private:
  Vec2 share_{0.0, 1.0};  // position in the free room of the picture, 0..1 per axis
};

}  // namespace hapticast::client
