// SPDX-License-Identifier: MIT
// Layout of the window: status line, picture and panel.
// Thread: any (pure function).
#pragma once

#include <optional>

#include "common/geometry.hpp"

namespace hapticast::client {

/// Rectangles of the window's parts, px of the window. The panel is at the right edge.
struct WindowLayout {
  int text_px = 15;       ///< height of the text
  double head_px = 27.0;  ///< height of the status line above the picture
  double panel_px = 0.0;  ///< width of the panel; 0 while it is folded
  /// Rectangle for the picture: its upper left corner, and (`room`) its width and height.
  Vec2 corner = Vec2::Zero();
  Vec2 room = Vec2::Zero();

  [[nodiscard]] bool isFolded() const { return panel_px == 0.0; }
};

/// Windows narrower than this fold the panel, unless the user unfolds it. The value is a choice.
inline constexpr double kFoldBelow_px = 900.0;

/// Returns the layout of a window of the size `window_px`. `panel_wanted` is the user's choice, if
/// there is one. The panel is never wider than a third of the window.
[[nodiscard]] WindowLayout arrangeWindow(const Vec2& window_px, std::optional<bool> panel_wanted);

/// Returns the width of the buttons beside the status line, px. They exist only while the panel is
/// folded; otherwise the width is 0.
[[nodiscard]] inline double buttonsWidth_px(const WindowLayout& layout) {
  return layout.isFolded() ? 13.0 * layout.text_px : 0.0;
}

}  // namespace hapticast::client
