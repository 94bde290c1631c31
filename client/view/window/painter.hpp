// SPDX-License-Identifier: MIT
// Draws what Dear ImGui has collected with SDL's 2-D renderer, which every machine has, also one
// without OpenGL or a display. Thread: main.
#pragma once

#include <SDL.h>
#include <imgui.h>

#include <memory>

namespace hapticast::client {

struct TextureEnd {
  void operator()(SDL_Texture* texture) const { SDL_DestroyTexture(texture); }
};
using Texture = std::unique_ptr<SDL_Texture, TextureEnd>;

class WindowPainter {
 public:
  /// Needs a current ImGui context, which like `renderer` outlives the painter.
  explicit WindowPainter(SDL_Renderer& renderer);

  /// Text has this height from the next frame on. Between frames.
  void setTextHeight(int height_px);
  void paint(const ImDrawData& data);

 private:
  void paintList(const ImDrawList& list, const ImDrawData& data);

  SDL_Renderer& renderer_;
  Texture font_;
  int text_height_px_ = 0;
};

}  // namespace hapticast::client
