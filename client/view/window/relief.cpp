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
constexpr double kStylus_mm = 16.0;
constexpr double kConeRadius_mm = 4.5;
// Chosen: the view follows a HIP up to this distance from the relief.
constexpr double kNear_mm = 14.0;

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

ImU32 computeColor(float light) {
  const auto part = [light](float most) { return static_cast<int>(most * std::min(light, 1.0F)); };
  return IM_COL32(part(255.0F), part(225.0F), part(185.0F), 255);
}

/// Orthographic projection of the workspace from the side.
class Aside {
 public:
  /// Shows `mesh`, and the stylus at `tip_mm` if it is near, in the rectangle `box`.
  Aside(const ReliefMesh& mesh, const Vec3& tip_mm, const cv::Rect2d& box, double yaw_rad,
        double pitch_rad)
      : rotation_((Eigen::AngleAxisd(pitch_rad, Vec3::UnitX()) *
                   Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()))
                      .toRotationMatrix()),
        middle_(box.x + 0.5 * box.width, box.y + 0.5 * box.height) {
    Vec3 low = Vec3::Constant(1e9);
    Vec3 high = Vec3::Constant(-1e9);
    for (const ReliefMesh::Corner& corner : mesh.corners) {
      low = low.cwiseMin(corner.position_mm);
      high = high.cwiseMax(corner.position_mm);
    }
    if (mesh.corners.empty()) low = high = Vec3::Zero();
    const Vec3 near_mm =
        tip_mm.cwiseMax(low - Vec3::Constant(kNear_mm)).cwiseMin(high + Vec3::Constant(kNear_mm));
    low = low.cwiseMin(near_mm);
    high = high.cwiseMax(near_mm + Vec3(0.0, 0.0, kStylus_mm));
    centre_mm_ = 0.5 * (low + high);
    fit(low, high, Vec2(box.width, box.height));
  }
  /// Returns a position in the directions of the view: right, up, towards the viewer.
  [[nodiscard]] Vec3 rotatePoint(const Vec3& nominal_mm) const {
    return rotation_ * (nominal_mm - centre_mm_);
  }
  /// Returns the point of the window at which a position is drawn.
  [[nodiscard]] Vec2 operator()(const Vec3& nominal_mm) const {
    const Vec3 seen = px_per_mm_ * rotatePoint(nominal_mm);
    return middle_ + Vec2(seen.x(), -seen.y());
  }

 private:
  /// Chooses the scale at which the rotated corners of a block fit into `size_px`.
  void fit(const Vec3& low_mm, const Vec3& high_mm, const Vec2& size_px) {
    const Vec3 half_mm = rotation_.cwiseAbs() * (0.5 * (high_mm - low_mm));
    const Vec2 needed_mm = half_mm.head<2>() + Vec2::Constant(kConeRadius_mm);
    px_per_mm_ = (0.5 * size_px).cwiseQuotient(needed_mm).minCoeff();
  }

  Eigen::Matrix3d rotation_;
  Vec2 middle_;
  Vec3 centre_mm_;
  double px_per_mm_ = 1.0;
};

/// Painter's algorithm: returns the cells from the farthest to the nearest.
std::vector<std::size_t> sortFromBehind(const ReliefMesh& mesh, const Aside& aside) {
  std::vector<double> near(mesh.cells.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    for (const int corner : mesh.cells[i])
      near[i] += aside.rotatePoint(mesh.corners[static_cast<std::size_t>(corner)].position_mm).z();
  }
  std::vector<std::size_t> order(mesh.cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&near](std::size_t a, std::size_t b) { return near[a] < near[b]; });
  return order;
}

/// Draws the cells, as `aside` projects them.
void drawCells(ImDrawList& list, const ReliefMesh& mesh, const Aside& aside) {
  const std::vector<std::size_t> order = sortFromBehind(mesh, aside);
  if (order.empty()) return;
  const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
  list.PrimReserve(static_cast<int>(6 * order.size()), static_cast<int>(mesh.corners.size()));
  const unsigned first = list._VtxCurrentIdx;
  for (const ReliefMesh::Corner& corner : mesh.corners)
    list.PrimWriteVtx(toImVec(aside(corner.position_mm)), white, computeColor(corner.light));
  for (const std::size_t cell : order) {
    for (const std::size_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) {
      list.PrimWriteIdx(
          static_cast<ImDrawIdx>(first + static_cast<unsigned>(mesh.cells[cell][corner])));
    }
  }
}

/// Draws the stylus as a cone with its apex at the HIP.
void drawConeInSpace(ImDrawList& list, const Aside& aside, const Vec3& tip_mm) {
  constexpr int kSides = 24;
  std::array<ImVec2, kSides> opening;
  for (std::size_t i = 0; i < opening.size(); ++i) {
    const double angle_rad = 6.283185307179586 * static_cast<double>(i) / kSides;
    opening[i] = toImVec(aside(tip_mm + Vec3(kConeRadius_mm * std::cos(angle_rad),
                                             kConeRadius_mm * std::sin(angle_rad), kStylus_mm)));
  }
  const ImVec2 tip = toImVec(aside(tip_mm));
  for (std::size_t i = 0; i < opening.size(); ++i)
    list.AddTriangleFilled(tip, opening[i], opening[(i + 1) % opening.size()],
                           IM_COL32(40, 150, 140, 255));
  list.AddConvexPolyFilled(opening.data(), kSides, IM_COL32(120, 235, 220, 255));
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
  drawConeInSpace(list, aside, tip_mm);
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
  if (!mesh_ || least_px != cell_px_) {
    mesh_ = buildMesh(reliefs_, workspace_, least_px);
    cut_mesh_.reset();
  }
  cell_px_ = least_px;
  return *mesh_;
}

const ReliefMesh& WindowRelief::cutMesh(const ScenePlace& place) {
  const ReliefMesh& whole = mesh(place);
  if (!cut_mesh_) cut_mesh_ = cutWalls(whole);
  return *cut_mesh_;
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

void WindowRelief::drawInSpace(ImDrawList& list, const ScenePlace& place,
                               const TickReport& report) {
  const cv::Rect2d box = box_.rect(place);
  const ImVec2 corner = toImVec({box.x, box.y});
  const ImVec2 end = toImVec({box.br().x, box.br().y});
  const auto title = static_cast<float>(ReliefBox::kTitle_px);
  list.PushClipRect(corner, end, true);
  list.AddRectFilled(corner, end, IM_COL32(18, 20, 24, 225));
  const cv::Rect2d body(box.x, box.y + ReliefBox::kTitle_px, box.width,
                        box.height - ReliefBox::kTitle_px);
  const ReliefMesh& shape = cutMesh(place);
  const Aside aside(shape, report.hip_mm, body, yaw_rad_, pitch_rad_);
  drawCells(list, shape, aside);
  drawTouchInSpace(list, aside, report);
  list.AddRectFilled(corner, {end.x, corner.y + title}, IM_COL32(44, 50, 60, 255));
  list.AddText({corner.x + 5.0F, corner.y + 3.0F}, IM_COL32(200, 200, 200, 255),
               "relief: drag below to turn");
  const ImVec2 cross(end.x - 0.5F * title, corner.y + 0.5F * title);
  constexpr float kArm_px = 5.0F;
  for (const float side : {-kArm_px, kArm_px})
    list.AddLine({cross.x - kArm_px, cross.y - side}, {cross.x + kArm_px, cross.y + side},
                 IM_COL32(230, 230, 230, 255), 2.0F);
  list.AddRect(corner, end, IM_COL32(120, 120, 120, 255));
  list.PopClipRect();
}

}  // namespace hapticast::client

#endif  // HAPTICAST_IMGUI
