// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/painter.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

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

WindowPainter::WindowPainter(SDL_Renderer& renderer) : renderer_(renderer) {
  ImGuiIO& io = ImGui::GetIO();
  io.BackendRendererName = "SDL_Renderer";
  io.BackendFlags |= ImGuiBackendFlags_RendererHasVtxOffset;
  // The software renderer does not interpolate textures, so thin lines are triangles.
  io.Fonts->Flags |= ImFontAtlasFlags_NoBakedLines;
}

void WindowPainter::setTextHeight(int height_px) {
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

void WindowPainter::paint(const ImDrawData& data) {
  SDL_RenderSetScale(&renderer_, data.FramebufferScale.x, data.FramebufferScale.y);
  for (int i = 0; i < data.CmdListsCount; ++i) paintList(*data.CmdLists[i], data);
  SDL_RenderSetClipRect(&renderer_, nullptr);
}

void WindowPainter::paintList(const ImDrawList& list, const ImDrawData& data) {
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

namespace {
constexpr double kPlot_s = 8.0;  // chosen: a press and its release
}

void plot(const ForceHistory& history, double most, const char* unit, float height,
          std::span<const Curve> curves) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size(ImGui::GetContentRegionAvail().x, height);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end(corner.x + size.x, corner.y + size.y);
  list.AddRectFilled(corner, end, IM_COL32(18, 20, 24, 255));
  const auto& points = history.points();
  const double now_s = points.empty() ? 0.0 : points.back().time_s;
  constexpr double kPoint_s = ForceHistory::kTicksPerPoint * 1e-3;
  const auto shown = std::min(points.size(), static_cast<std::size_t>(kPlot_s / kPoint_s));
  // One point per pixel is enough.
  const std::size_t stride = std::max<std::size_t>(1, shown / static_cast<std::size_t>(size.x + 1));
  for (const Curve& curve : curves) {
    for (std::size_t i = points.size() - shown; i < points.size(); i += stride) {
      const double age = (now_s - points[i].time_s) / kPlot_s;
      const double share = std::clamp(points[i].*curve.value / most, 0.0, 1.0);
      list.PathLineTo({end.x - size.x * static_cast<float>(age),
                       end.y - 1.0F - (size.y - 3.0F) * static_cast<float>(share)});
    }
    list.PathStroke(curve.color, 0, 1.5F);
  }
  const std::string scale = fmt::format("{:g} {}", most, unit);
  list.AddText({corner.x + 3.0F, corner.y + 1.0F}, IM_COL32(150, 150, 150, 255), scale.c_str());
  ImGui::Dummy(size);
}

double upperEnvelope(const ForceHistory& history, double ForcePoint::*value, double least) {
  const auto& points = history.points();
  double most = least;
  const double from_s = points.empty() ? 0.0 : points.back().time_s - kPlot_s;
  for (const ForcePoint& point : points) {
    while (point.time_s >= from_s && point.*value > most && most < 1e6) most *= 2.0;
  }
  return most;
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
