// SPDX-License-Identifier: MIT
// Draws the output of Dear ImGui with SDL's 2-D renderer. That renderer needs neither OpenGL nor a
// display.
// Thread: main.
#pragma once

#include <SDL.h>
#include <imgui.h>
#include <memory>
#include <span>

#include "client/view/force_plot.hpp"

namespace hapticast::client {

struct TextureEnd {
  void operator()(SDL_Texture* texture) const { SDL_DestroyTexture(texture); }
};
using Texture = std::unique_ptr<SDL_Texture, TextureEnd>;

class WindowPainter {
 public:
  /// Draws with `renderer`. Requires a current ImGui context. Context and `renderer` must outlive
  /// this object.
  explicit WindowPainter(SDL_Renderer& renderer);

  /// Sets the height of the text, from the next frame on. Call it between two frames.
  void setTextHeight(int height_px);
  void paint(const ImDrawData& data);

 private:
  void paintList(const ImDrawList& list, const ImDrawData& data);

  SDL_Renderer& renderer_;
  Texture font_;
  int text_height_px_ = 0;
};

// Plots of the last seconds in the panel.
// Thread: main.

/// One line of a plot.
struct Curve {
  double ForcePoint::*value;
  ImU32 color;
};

/// Draws a plot of `curves`, as wide as the panel. The vertical axis extends from 0 to `most`, with
/// the unit `unit`. `height` is the height of the plot in px of the window.
void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves);

/// Returns the end of a plot's vertical axis: a round number above all values in the plotted time.
/// It is at least `least`.
[[nodiscard]] double upperEnvelope(const ForceHistory& history, double ForcePoint::*value,
                                   double least);

}  // namespace hapticast::client
