// SPDX-License-Identifier: MIT
// What is drawn over the video of the window: the stylus as a cone, the contact and the forces.
// Thread: main.
#pragma once

#include <imgui.h>

#include "client/haptics/pointer.hpp"
#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

// The colours of the forces, here and in the plots.
inline constexpr ImU32 kStaticColor = IM_COL32(64, 120, 255, 255);
inline constexpr ImU32 kDynamicColor = IM_COL32(255, 56, 48, 255);
inline constexpr ImU32 kTotalColor = IM_COL32(255, 214, 64, 255);

/// Where on the window a stream's picture is: as large as fits, in its own proportions.
class ScenePlace {
 public:
  ScenePlace(const Workspace& workspace, const ImVec2& corner, const ImVec2& room);

  [[nodiscard]] const ImVec2& corner() const { return corner_; }
  [[nodiscard]] ImVec2 end() const;
  [[nodiscard]] bool contains(const ImVec2& point) const;
  /// A point of the window and the nominal (x, y) that is seen there.
  [[nodiscard]] ImVec2 toWindow(const Vec2& nominal_mm) const;
  [[nodiscard]] ImVec2 fromImage(const Vec2& image_px) const;
  [[nodiscard]] Vec2 toNominal(const ImVec2& point) const;
  /// An arrow from the tip: x right, y up, z towards the viewer drawn obliquely, up and a little to
  /// the right.
  [[nodiscard]] ImVec2 arrow(const Vec3& force_N) const;
  [[nodiscard]] float pixelsPerMm() const;

 private:
  Workspace workspace_;
  ImVec2 corner_;
  float scale_;  // window px a px of the picture
};

/// Kept where drawing arithmetic stays exact; what is not finite is 0.
[[nodiscard]] float bounded(double value);

void drawArrow(ImDrawList& list, const ImVec2& from, const ImVec2& way, float width, ImU32 color);

/// Draws cone, contact and arrows of `report`, and where the pointer pulls the tip to.
void drawScene(ImDrawList& list, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer);

}  // namespace hapticast::client
