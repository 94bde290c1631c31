// SPDX-License-Identifier: MIT
// Overlay of the window's video: the stylus as a cone, the contact and the forces.
// Thread: main.
#pragma once

#include <imgui.h>

#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

// Colours of the forces, here and in the plots.
inline constexpr ImU32 kStaticColor = IM_COL32(64, 120, 255, 255);
inline constexpr ImU32 kDynamicColor = IM_COL32(255, 56, 48, 255);
inline constexpr ImU32 kTotalColor = IM_COL32(255, 214, 64, 255);

/// Position of the stream's picture in the window: as large as possible at its aspect ratio.
class ScenePlace {
 public:
  ScenePlace(const Workspace& workspace, const ImVec2& corner, const ImVec2& room);

  [[nodiscard]] const ImVec2& corner() const { return corner_; }
  [[nodiscard]] ImVec2 end() const;
  [[nodiscard]] bool contains(const ImVec2& point) const;
  /// Conversions between the window and nominal (x, y) or image px.
  [[nodiscard]] ImVec2 toWindow(const Vec2& nominal_mm) const;
  [[nodiscard]] ImVec2 fromImage(const Vec2& image_px) const;
  [[nodiscard]] Vec2 toNominal(const ImVec2& point) const;
  /// Returns an arrow for a force at the HIP: x to the right, y up. z points at the viewer and is
  /// drawn obliquely, up and a little to the right.
  [[nodiscard]] ImVec2 arrow(const Vec3& force_N) const;
  [[nodiscard]] float pixelsPerMm() const;

 private:
  Workspace workspace_;
  ImVec2 corner_;
  float scale_;  // window px per px of the picture
};

/// Clamps `value` to the exact range of the drawing functions; 0 if it is not finite.
[[nodiscard]] float bounded(double value);

/// Draws an arrow from `from` along `way`.
void drawArrow(ImDrawList& list, const ImVec2& from, const ImVec2& way, float width, ImU32 color);

/// Draws cone, contact and arrows of `report`, and the target of the pointer.
void drawScene(ImDrawList& list, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer);

}  // namespace hapticast::client
