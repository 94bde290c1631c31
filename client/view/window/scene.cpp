// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/scene.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::client {

namespace {

constexpr float kArrowShare = 0.09F;  // share of the picture's width per N; 3.3 N are a third of it
constexpr float kStylusCone_mm = 18.0F;
// Distance of the eye for the perspective. Chosen: 120 nominal mm, so that a nearer cone is visibly
// larger.
constexpr double kEye_mm = 120.0;
const Vec2 kTowardsViewer(0.35, -0.75);  // up and a little to the right, px per px

ImVec2 plus(const ImVec2& a, const ImVec2& b) { return {a.x + b.x, a.y + b.y}; }
ImVec2 times(const ImVec2& a, float factor) { return {a.x * factor, a.y * factor}; }
float computeLength(const ImVec2& a) { return std::hypot(a.x, a.y); }

/// Draws the stylus: a cone with its apex at the HIP, opening towards the viewer; the nearer, the
/// larger.
void drawCone(ImDrawList& list, const ImVec2& tip, float size) {
  constexpr int kSides = 28;
  const ImVec2 axis(static_cast<float>(kTowardsViewer.x()) * size,
                    static_cast<float>(kTowardsViewer.y()) * size);
  const ImVec2 top = plus(tip, axis);
  const float radius = 0.24F * size;
  const ImVec2 along = times(axis, 1.0F / computeLength(axis));
  const ImVec2 across(-along.y, along.x);
  const auto rim = [&](float angle) {
    return plus(top, plus(times(across, radius * std::cos(angle)),
                          times(along, 0.4F * radius * std::sin(angle))));
  };
  const ImVec2 left = rim(0.0F);
  const ImVec2 right = rim(3.14159265F);
  list.AddTriangleFilled(tip, left, top, IM_COL32(70, 205, 190, 190));
  list.AddTriangleFilled(tip, top, right, IM_COL32(40, 150, 140, 190));
  for (int i = 0; i < kSides; ++i) {
    list.PathLineTo(rim(6.2831853F * static_cast<float>(i) / kSides));
  }
  list.PathFillConvex(IM_COL32(120, 235, 220, 225));
  list.AddCircleFilled(tip, 3.5F, IM_COL32(255, 255, 255, 255));
}

}  // namespace

float bounded(double value) {
  return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e5, 1e5)) : 0.0F;
}

void drawArrow(ImDrawList& list, const ImVec2& from, const ImVec2& way, float width, ImU32 color) {
  const float length = computeLength(way);
  if (length < 2.0F) return;
  const ImVec2 along = times(way, 1.0F / length);
  const ImVec2 across(-along.y, along.x);
  const float head = std::min(length, 4.0F * width);
  const ImVec2 end = plus(from, way);
  const ImVec2 neck = plus(end, times(along, -head));
  list.AddLine(from, neck, color, width);
  list.AddTriangleFilled(end, plus(neck, times(across, 0.5F * head)),
                         plus(neck, times(across, -0.5F * head)), color);
}

ScenePlace::ScenePlace(const Workspace& workspace, const ImVec2& corner, const ImVec2& room)
    : workspace_(workspace) {
  const auto width = static_cast<float>(workspace.width_px);
  const auto height = static_cast<float>(workspace.height_px);
  scale_ = std::max(std::min(room.x / width, room.y / height), 1e-3F);
  corner_ = {corner.x + 0.5F * (room.x - scale_ * width),
             corner.y + 0.5F * (room.y - scale_ * height)};
}

ImVec2 ScenePlace::end() const {
  return {corner_.x + scale_ * static_cast<float>(workspace_.width_px),
          corner_.y + scale_ * static_cast<float>(workspace_.height_px)};
}

bool ScenePlace::contains(const ImVec2& point) const {
  return point.x >= corner_.x && point.y >= corner_.y && point.x < end().x && point.y < end().y;
}

ImVec2 ScenePlace::toWindow(const Vec2& nominal_mm) const {
  return fromImage(workspace_.toImage(nominal_mm));
}

ImVec2 ScenePlace::fromImage(const Vec2& image_px) const {
  return {corner_.x + scale_ * bounded(image_px.x()), corner_.y + scale_ * bounded(image_px.y())};
}

Vec2 ScenePlace::toNominal(const ImVec2& point) const {
  return workspace_.toNominal(Vec2(point.x - corner_.x, point.y - corner_.y) / double{scale_});
}

ImVec2 ScenePlace::arrow(const Vec3& force_N) const {
  const Vec2 way = Vec2(force_N.x(), -force_N.y()) + kTowardsViewer * force_N.z();
  const float px_per_N = kArrowShare * (end().x - corner_.x);
  return {px_per_N * bounded(way.x()), px_per_N * bounded(way.y())};
}

float ScenePlace::pixelsPerMm() const {
  return scale_ * static_cast<float>(workspace_.pixelsPerMm().x());
}

void drawScene(ImDrawList& list, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer) {
  list.PushClipRect(place.corner(), place.end(), true);
  const ImVec2 tip = place.toWindow(report.hip_mm.head<2>());
  if (pointer.known) {
    const ImVec2 goal = place.toWindow(pointer.position_mm.head<2>());
    list.AddLine(goal, tip, IM_COL32(255, 255, 255, 130), 1.0F);
    list.AddCircle(goal, 6.0F, IM_COL32(255, 255, 255, 220), 0, 1.5F);
  }
  const double nearness = kEye_mm / std::max(kEye_mm - report.hip_mm.z(), 0.3 * kEye_mm);
  drawCone(list, tip, kStylusCone_mm * place.pixelsPerMm() * static_cast<float>(nearness));
  if (report.contact) {
    const ImVec2 contact = place.toWindow(report.contact_mm.head<2>());
    list.AddCircle(contact, 7.0F, IM_COL32(90, 255, 120, 255), 0, 2.0F);
  }
  drawArrow(list, tip, place.arrow(report.force_N), 7.0F, kTotalColor);
  drawArrow(list, tip, place.arrow(report.static_force_N), 4.0F, kStaticColor);
  drawArrow(list, tip, place.arrow(report.dynamic_force_N), 4.0F, kDynamicColor);
  list.PopClipRect();
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
