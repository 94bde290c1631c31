// SPDX-License-Identifier: MIT
// Drawing over the window's video: the HIP as a cone, the contact, and the forces as arrows.
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

/// Position of the stream's picture in the window. The picture is as large as possible at its
/// aspect ratio.
class ScenePlace {
 public:
  ScenePlace(const Workspace& workspace, const ImVec2& corner, const ImVec2& room);

  [[nodiscard]] const ImVec2& corner() const { return corner_; }
  [[nodiscard]] ImVec2 end() const;
  [[nodiscard]] bool contains(const ImVec2& point) const;
  /// Convert between a point of the window and nominal (x, y) or image px.
  [[nodiscard]] ImVec2 toWindow(const Vec2& nominal_mm) const;
  [[nodiscard]] ImVec2 fromImage(const Vec2& image_px) const;
  [[nodiscard]] Vec2 toNominal(const ImVec2& point) const;
  /// Returns the arrow for a force, in px of the window. The x component of the force points to the
  /// right, and the y component up. The z component points to the viewer, so the arrow shows it
  /// obliquely: up and a little to the right.
  [[nodiscard]] ImVec2 arrow(const Vec3& force_N) const;
  [[nodiscard]] float pixelsPerMm() const;

 private:
  Workspace workspace_;
  ImVec2 corner_;
  float scale_;  // window px per px of the picture
};

/// Returns `value`, clamped to the range that the drawing functions can represent. Returns 0 if it
/// is not finite.
[[nodiscard]] float bounded(double value);

/// Draws an arrow that begins at `from` and has the direction and length of `way`.
void drawArrow(ImDrawList& list, const ImVec2& from, const ImVec2& way, float width, ImU32 color);

/// Draws the HIP, the contact and the forces of `report`, and the target of the pointer.
void drawScene(ImDrawList& list, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer);

}  // namespace hapticast::client
