// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/gui_renderer.hpp"

#include <cmath>
#include <filesystem>

namespace hapticast::client {

namespace {

// From Debian's fonts-dejavu-core; without it ImGui's own font is used.
constexpr const char* kFontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";

/// Returns the clip rectangle of a command.
SDL_Rect toClipRect(const ImDrawCmd& command, const ImDrawData& data) {
  const auto whole = [](float value) { return static_cast<int>(std::lround(value)); };
  const ImVec4& clip = command.ClipRect;
  SDL_Rect rect;
  rect.x = whole(clip.x - data.DisplayPos.x);
  rect.y = whole(clip.y - data.DisplayPos.y);
  rect.w = whole(clip.z - clip.x);
  rect.h = whole(clip.w - clip.y);
  return rect;
}

}  // namespace

GuiRenderer::GuiRenderer(SDL_Renderer& renderer) : renderer_(renderer) {
  ImGuiIO& io = ImGui::GetIO();
  io.BackendRendererName = "SDL_Renderer";
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  // The software renderer does not interpolate textures, so thin lines are triangles.
  io.Fonts->Flags |= ImFontAtlasFlags_NoBakedLines;
}

void GuiRenderer::setTextHeight(int height_px) {
  if (height_px == text_height_px_) return;
  text_height_px_ = height_px;
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  const auto height = static_cast<float>(height_px);
  if (std::filesystem::exists(kFontFile)) {
    fonts.AddFontFromFileTTF(kFontFile, height);
  } else {
    ImFontConfig own;
    own.SizePixels = height;
    fonts.AddFontDefault(&own);
  }
  unsigned char* pixels = nullptr;
  int width = 0;
  int rows = 0;
  fonts.GetTexDataAsRGBA32(&pixels, &width, &rows);
  font_.reset(
      SDL_CreateTexture(&renderer_, SDL_PIXELFORMAT_RGBA32, SDL_TEXTUREACCESS_STATIC, width, rows));
  SDL_UpdateTexture(font_.get(), nullptr, pixels, 4 * width);
  SDL_SetTextureBlendMode(font_.get(), SDL_BLENDMODE_BLEND);
  SDL_SetTextureScaleMode(font_.get(), SDL_ScaleModeLinear);
  fonts.SetTexID(font_.get());
}

ImTextureID GuiRenderer::upload(GuiImage kind, const cv::Mat& image) {
  Image& shown = images_[static_cast<std::size_t>(kind)];
  if (!shown.texture || shown.size != image.size()) {
    shown.size = image.size();
    shown.texture.reset(SDL_CreateTexture(&renderer_, SDL_PIXELFORMAT_BGR24,
                                          SDL_TEXTUREACCESS_STREAMING, image.cols, image.rows));
  }
  SDL_UpdateTexture(shown.texture.get(), nullptr, image.data, static_cast<int>(image.step));
  return shown.texture.get();
}

void GuiRenderer::paint(const ImDrawData& data) {
  SDL_RenderSetScale(&renderer_, data.FramebufferScale.x, data.FramebufferScale.y);
  for (int i = 0; i < data.CmdListsCount; ++i) paintList(*data.CmdLists[i], data);
  SDL_RenderSetClipRect(&renderer_, nullptr);
}

void GuiRenderer::paintList(const ImDrawList& list, const ImDrawData& data) {
  for (const ImDrawCmd& command : list.CmdBuffer) {
    const SDL_Rect clip = toClipRect(command, data);
    if (command.UserCallback != nullptr || clip.w <= 0 || clip.h <= 0) continue;
    SDL_RenderSetClipRect(&renderer_, &clip);
    const ImDrawVert* const vertex = list.VtxBuffer.Data + command.VtxOffset;
    constexpr int kStride = sizeof(ImDrawVert);
    // Both libraries have the same colour format: four bytes of red, green, blue and opacity.
    const auto* const color = reinterpret_cast<const SDL_Color*>(&vertex->col);
    SDL_RenderGeometryRaw(&renderer_, static_cast<SDL_Texture*>(command.GetTexID()), &vertex->pos.x,
                          kStride, color, kStride, &vertex->uv.x, kStride,
                          list.VtxBuffer.Size - static_cast<int>(command.VtxOffset),
                          list.IdxBuffer.Data + command.IdxOffset,
                          static_cast<int>(command.ElemCount), sizeof(ImDrawIdx));
  }
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
