// SPDX-License-Identifier: MIT
// Renderer of Dear ImGui's draw data with SDL's 2-D renderer, which needs neither OpenGL nor a
// display.
// Thread: main.
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

}  // namespace hapticast::client
