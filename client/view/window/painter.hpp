// SPDX-License-Identifier: MIT
// Renderer of Dear ImGui's draw data with SDL's 2-D renderer, which needs neither OpenGL nor a
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
  /// Requires a current ImGui context. Context and `renderer` must outlive this object.
  explicit WindowPainter(SDL_Renderer& renderer);

  /// Sets the text height from the next frame on. Call between frames.
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

/// Draws the curves from 0 to `most`, as wide as the panel.
void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves);

/// Returns a round number, at least `least`, above all values in the plotted time.
[[nodiscard]] double upperEnvelope(const ForceHistory& history, double ForcePoint::*value,
                                   double least);

}  // namespace hapticast::client
