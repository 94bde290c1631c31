// SPDX-License-Identifier: MIT
#include "client/view/window/layout.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {

constexpr double kCharacters = 90.0;      // of the longest line of status
constexpr double kCharacterWidth = 0.55;  // share of the height, mean of the font

int textHeight_px(const Vec2& window_px) {
  return window_px.y() < 600.0 ? 13 : window_px.y() < 1000.0 ? 15 : 19;
}

double panelWidth_px(double window_px) {
  const double least_px = std::min(250.0, window_px / 3.0);
  return std::clamp(0.3 * window_px, least_px, 460.0);
}

}  // namespace

WindowLayout arrangeWindow(const Vec2& window_px, std::optional<bool> panel_wanted) {
  WindowLayout layout;
  layout.text_px = textHeight_px(window_px);
  if (panel_wanted.value_or(window_px.x() >= kFoldBelow_px))
    layout.panel_px = panelWidth_px(window_px.x());
  const double width_px = window_px.x() - layout.panel_px;
  const double line_px = kCharacters * kCharacterWidth * layout.text_px;
  const bool one_line = width_px - buttonsWidth_px(layout) >= line_px;
  layout.head_px = (one_line ? 1.8 : 2.9) * layout.text_px;
  layout.corner = {0.0, layout.head_px};
  layout.room = {std::max(width_px, 1.0), std::max(window_px.y() - layout.head_px, 1.0)};
  return layout;
}

}  // namespace hapticast::client
