// SPDX-License-Identifier: MIT
#if HAPTICAST_IMGUI
#include "client/view/window/relief.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "client/view/window/gui_renderer.hpp"

namespace hapticast::client {

namespace {

constexpr double kTurn_rad_per_px = 0.01;  // chosen: about half a turn across the box
// The software renderer leaves holes between smaller triangles (measured), px of the window.
constexpr double kCell_px = 4.0;
constexpr double kArrow_mm_per_N = 12.0;
constexpr double kStylus_mm = 25.0;

float toFloat(double value) {
  return std::isfinite(value) ? static_cast<float>(std::clamp(value, -1e5, 1e5)) : 0.0F;
}
ImVec2 toImVec(const Vec2& point) { return {toFloat(point.x()), toFloat(point.y())}; }

/// Draws an arrow from `from` to `end`.
void drawArrow(ImDrawList& list, const Vec2& from, const Vec2& end, ImU32 color) {
  constexpr double kWidth_px = 4.0;
  const Vec2 way = end - from;
  const double length = way.norm();
  if (length < 2.0) return;
  const double head = std::min(length, 4.0 * kWidth_px);
  const Vec2 neck = end - way * (head / length);
  const Vec2 side = Vec2(-way.y(), way.x()) * (0.5 * head / length);
  list.AddLine(toImVec(from), toImVec(neck), color, static_cast<float>(kWidth_px));
  list.AddTriangleFilled(toImVec(end), toImVec(neck + side), toImVec(neck - side), color);
}

ImU32 lit(float light) {
  const auto part = [light](float most) { return static_cast<int>(most * std::min(light, 1.0F)); };
  return IM_COL32(part(255.0F), part(225.0F), part(185.0F), 255);
}

/// Orthographic projection of the workspace from the side.
class Aside {
 public:
  Aside(const ReliefMesh& mesh, const ImVec4& box, double yaw_rad, double pitch_rad)
      : rotation_((Eigen::AngleAxisd(pitch_rad, Vec3::UnitX()) *
                   Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()))
                      .toRotationMatrix()),
        middle_(0.5 * Vec2(box.x + box.z, box.y + box.w)) {
    Vec3 low = Vec3::Constant(1e9);
    Vec3 high = Vec3::Constant(-1e9);
    for (const ReliefMesh::Corner& corner : mesh.corners) {
      low = low.cwiseMin(corner.position_mm);
      high = high.cwiseMax(corner.position_mm);
    }
    if (mesh.corners.empty()) low = high = Vec3::Zero();
    centre_mm_ = 0.5 * (low + high);
    // Margin for the stylus.
    const double across_mm = (high - low).head<2>().norm() + kStylus_mm;
    px_per_mm_ = static_cast<double>(std::min(box.z - box.x, box.w - box.y)) / across_mm;
  }
  [[nodiscard]] Vec3 rotated(const Vec3& nominal_mm) const {
    return rotation_ * (nominal_mm - centre_mm_);
  }
  [[nodiscard]] Vec2 operator()(const Vec3& nominal_mm) const {
    const Vec3 seen = px_per_mm_ * rotated(nominal_mm);
    return middle_ + Vec2(seen.x(), -seen.y());
  }

 private:
  Eigen::Matrix3d rotation_;
  Vec2 middle_;
  Vec3 centre_mm_;
  double px_per_mm_;
};

/// Painter's algorithm: returns the cells from the farthest to the nearest.
std::vector<std::size_t> fromBehind(const ReliefMesh& mesh, const Aside& aside) {
  std::vector<double> near(mesh.cells.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (const int corner : mesh.cells[i])
      near[i] += aside.rotated(mesh.corners[static_cast<std::size_t>(corner)].position_mm).z();
  }
  std::vector<std::size_t> order(mesh.cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&near](std::size_t a, std::size_t b) { return near[a] < near[b]; });
  return order;
}

/// Draws the cells, as `aside` projects them.
void drawCells(ImDrawList& list, const ReliefMesh& mesh, const Aside& aside) {
  const std::vector<std::size_t> order = fromBehind(mesh, aside);
  if (order.empty()) return;
  const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
  list.PrimReserve(static_cast<int>(6 * order.size()), static_cast<int>(mesh.corners.size()));
  const unsigned first = list._VtxCurrentIdx;
  for (const ReliefMesh::Corner& corner : mesh.corners)
    list.PrimWriteVtx(toImVec(aside(corner.position_mm)), white, lit(corner.light));
  for (const std::size_t cell : order) {
    for (const std::size_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
      list.PrimWriteIdx(
          static_cast<ImDrawIdx>(first + static_cast<unsigned>(mesh.cells[cell][corner])));
    }
  }
}

/// Draws stylus, HIP, surface point and force.
void drawTouchInSpace(ImDrawList& list, const Aside& aside, const TickReport& report) {
  const Vec3& tip_mm = report.hip_mm;
  const Vec2 tip = aside(tip_mm);
  if (report.contact) {
    const ImVec2 held = toImVec(aside(report.contact_mm));
    list.AddLine(toImVec(tip), held, toImGui(kContactColor), 1.5F);
    list.AddCircle(held, 5.0F, toImGui(kContactColor), 0, 2.0F);
  }
  list.AddLine(toImVec(tip), toImVec(aside(tip_mm + Vec3(0.0, 0.0, kStylus_mm))),
               IM_COL32(70, 205, 190, 255), 3.0F);
  list.AddCircleFilled(toImVec(tip), 4.0F, IM_COL32(255, 255, 255, 255));
  drawArrow(list, tip, aside(tip_mm + kArrow_mm_per_N * report.force_N), toImGui(kForceColor));
}

}  // namespace

void WindowRelief::onFrame(const PlayableReliefs& frame) {
  const std::lock_guard lock(mutex_);
  // A frame older than the newest one belongs to a restarted server.
  if (!frames_.empty() && frame.media_time < frames_.back().media_time) frames_.clear();
  frames_.push_back(frame);
  if (frames_.size() > kMostFrames) frames_.pop_front();
}

void WindowRelief::update(MediaTime play_time, const Workspace& workspace) {
  const auto off = [play_time](MediaTime time) { return std::abs((time - play_time).count()); };
  const std::lock_guard lock(mutex_);
  const auto nearest = std::min_element(frames_.begin(), frames_.end(),
                                        [&off](const PlayableReliefs& a, const PlayableReliefs& b) {
                                          return off(a.media_time) < off(b.media_time);
                                        });
  if (nearest == frames_.end()) return;
  // During a pause frames continue to arrive, and the shown one leaves the queue.
  if (shown_ && off(*shown_) <= off(nearest->media_time)) return;
  shown_ = nearest->media_time;
  workspace_ = workspace;
  Reliefs reliefs;
  reliefs.reserve(nearest->reliefs.size());
  for (const auto& weak : nearest->reliefs) {
    if (auto relief = weak.lock()) reliefs.push_back(std::move(relief));
  }
  if (reliefs == reliefs_) return;
  reliefs_ = std::move(reliefs);
  mesh_.reset();
  outlines_.reset();
}

void WindowRelief::rotate(float right_px, float down_px) {
  yaw_rad_ = std::remainder(yaw_rad_ + kTurn_rad_per_px * double{right_px}, 6.283185307179586);
  pitch_rad_ = std::clamp(pitch_rad_ + kTurn_rad_per_px * double{down_px}, -1.5708, 0.0);
}

const ReliefMesh& WindowRelief::mesh(const ScenePlace& place) {
  const double px = place.pixelsPerMm() / workspace_.pixelsPerMm().x();
  const int least_px = std::max(1, static_cast<int>(std::ceil(kCell_px / px)));
  if (!mesh_ || least_px != cell_px_) mesh_ = buildMesh(reliefs_, workspace_, least_px);
  cell_px_ = least_px;
  return *mesh_;
}

void WindowRelief::drawOutline(cv::Mat& image, const ScenePlace& place) {
  if (!outlines_) {
    outlines_.emplace();
    for (const auto& relief : reliefs_) {
      for (auto& line : traceOutline(*relief)) outlines_->push_back(std::move(line));
    }
  }
  drawOutlines(image, place, *outlines_);
}

void WindowRelief::drawShaded(cv::Mat& image, const ScenePlace& place) {
  drawShade(image, place, mesh(place));
}

ImVec4 WindowRelief::box(const ScenePlace& place) {
  constexpr double kShare = 0.45;  // chosen: the middle of the picture stays free
  const ImVec2 end = toImVec(place.corner() + kShare * place.size());
  const ImVec2 corner = toImVec(place.corner());
  const float below = toImVec(place.end()).y - end.y;
  return {corner.x, corner.y + below, end.x, end.y + below};
}

void WindowRelief::drawInSpace(ImDrawList& list, const ScenePlace& place,
                               const TickReport& report) {
  const ImVec4 room = box(place);
  const ImVec2 corner(room.x, room.y);
  const ImVec2 end(room.z, room.w);
  list.PushClipRect(corner, end, true);
  list.AddRectFilled(corner, end, IM_COL32(18, 20, 24, 225));
  const Aside aside(mesh(place), room, yaw_rad_, pitch_rad_);
  drawCells(list, mesh(place), aside);
  drawTouchInSpace(list, aside, report);
  list.AddText({room.x + 5.0F, room.y + 3.0F}, IM_COL32(170, 170, 170, 255),
               "drag here to turn it");
  list.AddRect(corner, end, IM_COL32(120, 120, 120, 255));
  list.PopClipRect();
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
