// SPDX-License-Identifier: MIT
// Draws the output of Dear ImGui, and images inside it, with SDL's 2-D renderer. That renderer
// needs neither OpenGL nor a display. Thread: main.
#pragma once

#include <SDL.h>
#include <imgui.h>
#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>

namespace hapticast::client {

/// Returns a colour of the painter (BGR) for ImGui.
[[nodiscard]] inline ImU32 toImGui(const cv::Scalar& bgr) {
  return IM_COL32(static_cast<int>(bgr[2]), static_cast<int>(bgr[1]), static_cast<int>(bgr[0]),
                  255);
}

/// The images that the window shows.
enum class GuiImage : std::uint8_t { kScene, kForcePlot, kPenetrationPlot };

/// Draws ImGui's output with an SDL renderer.
class GuiRenderer {
 public:
  /// The object draws with `renderer`. Requires a current ImGui context. The context and `renderer`
  /// must outlive this object.
  explicit GuiRenderer(SDL_Renderer& renderer);

  /// Sets the height of the text, from the next frame on. Call it between two frames.
  void setTextHeight(int height_px);
  /// Uploads `image` (CV_8UC3), which replaces the last image of `kind`. Returns its texture for
  /// ImGui, which is valid until the next call for `kind`.
  [[nodiscard]] ImTextureID upload(GuiImage kind, const cv::Mat& image);
  /// Draws `data`, the output of ImGui for one frame.
  void paint(const ImDrawData& data);

 private:
  struct TextureEnd {
    void operator()(SDL_Texture* texture) const { SDL_DestroyTexture(texture); }
  };
  using Texture = std::unique_ptr<SDL_Texture, TextureEnd>;
  struct Image {
    Texture texture;
    cv::Size size;
  };
  void paintList(const ImDrawList& list, const ImDrawData& data);

  SDL_Renderer& renderer_;
  Texture font_;
  std::array<Image, 3> images_;  // by GuiImage
  int text_height_px_ = 0;
};

}  // namespace hapticast::client
