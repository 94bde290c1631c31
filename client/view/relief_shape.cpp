// SPDX-License-Identifier: MIT
#include "client/view/relief_shape.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace hapticast::client {

namespace {

// Chosen: limit of the pixels that an outline examines; a larger mask is subsampled.
constexpr double kMostPixels = 250'000.0;

/// Returns the step that leaves at most `most` points of this rectangle.
int chooseStep(const PixelRect& rect, double most) {
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(double(rect.pixels()) / most))));
}

float computeShade(const Vec2& gradient) {
  const Vec3 normal = Vec3(-gradient.x(), -gradient.y(), 1.0).normalized();
  const Vec3 to_lamp = Vec3(-0.4, 0.35, 0.85).normalized();
  constexpr double kAmbient = 0.15;
  return static_cast<float>(kAmbient + (1.0 - kAmbient) * std::max(0.0, normal.dot(to_lamp)));
}

/// Adds a relief with about `most_cells` cells.
void addRelief(ReliefMesh& mesh, const HeightField& relief, const Workspace& workspace,
               double most_cells, int least_px) {
  const PixelRect& rect = relief.rect();
  const int step = std::max(chooseStep(rect, most_cells), least_px);
  const int columns = (rect.width - 1) / step + 1;
  const int rows = (rect.height - 1) / step + 1;
  std::vector<int> number(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), -1);
  const auto at = [&](int column, int row) -> int& {
    return number[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                  static_cast<std::size_t>(column)];
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vec2 px(rect.u + column * step + 0.5, rect.v + row * step + 0.5);
      if (!relief.inside(px)) continue;
      const SurfaceSample sample = relief.bilinear(px);
      const Vec2 nominal_mm = workspace.toNominal(px);
      at(column, row) = static_cast<int>(mesh.corners.size());
      mesh.corners.push_back(
          {{nominal_mm.x(), nominal_mm.y(), sample.height_mm}, computeShade(sample.gradient)});
      if (row == 0 || column == 0) continue;
      const std::array cell{at(column - 1, row - 1), at(column, row - 1), at(column, row),
                            at(column - 1, row)};
      if (*std::min_element(cell.begin(), cell.end()) >= 0) mesh.cells.push_back(cell);
    }
  }
}

}  // namespace

std::vector<std::vector<cv::Point2f>> traceOutline(const HeightField& relief) {
  const PixelRect& rect = relief.rect();
  if (relief.empty()) return {};
  const int step = chooseStep(rect, kMostPixels);
  // A border of zeros closes the outline at the edge of the picture.
  cv::Mat mask = cv::Mat::zeros(rect.height / step + 3, rect.width / step + 3, CV_8UC1);
  for (int row = 0; row * step < rect.height; ++row) {
    for (int column = 0; column * step < rect.width; ++column) {
      const Vec2 px(rect.u + column * step + 0.5, rect.v + row * step + 0.5);
      if (relief.inside(px)) mask.at<std::uint8_t>(row + 1, column + 1) = 1;
    }
  }
  std::vector<std::vector<cv::Point>> edges;
  cv::findContours(mask, edges, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  std::vector<std::vector<cv::Point2f>> lines(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    lines[i].reserve(edges[i].size());
    for (const cv::Point& point : edges[i]) {
      lines[i].emplace_back(static_cast<float>(rect.u + (point.x - 1) * step) + 0.5F,
                            static_cast<float>(rect.v + (point.y - 1) * step) + 0.5F);
    }
  }
  return lines;
}

ReliefMesh buildMesh(const Reliefs& reliefs, const Workspace& workspace, int least_px) {
  ReliefMesh mesh;
  for (const auto& relief : reliefs) {
    if (relief->empty()) continue;
    addRelief(mesh, *relief, workspace,
              ReliefMesh::kMostCells / static_cast<double>(reliefs.size()), least_px);
  }
  return mesh;
}

bool isWall(const ReliefMesh& mesh, const std::array<int, 4>& cell) {
  constexpr double kSlope = 2.0;  // chosen: a sphere has it at 89 % of its radius
  const auto position_mm = [&](std::size_t i) -> const Vec3& {
    return mesh.corners[static_cast<std::size_t>(cell[i])].position_mm;
  };
  double low_mm = position_mm(0).z();
  double high_mm = low_mm;
  for (std::size_t i = 1; i < cell.size(); ++i) {
    low_mm = std::min(low_mm, position_mm(i).z());
    high_mm = std::max(high_mm, position_mm(i).z());
  }
  const double width_mm = (position_mm(1) - position_mm(0)).head<2>().norm();
  return high_mm - low_mm > kSlope * width_mm;
}

namespace {

using Edge = std::pair<int, int>;

/// Returns the edges that belong to one cell only.
std::vector<Edge> findRim(const ReliefMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(4 * mesh.cells.size());
  for (const auto& cell : mesh.cells) {
    for (std::size_t i = 0; i < cell.size(); ++i)
      edges.push_back(std::minmax({cell[i], cell[(i + 1) % cell.size()]}));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<Edge> rim;
  for (std::size_t i = 0; i < edges.size();) {
    const auto next =
        std::upper_bound(edges.begin() + static_cast<std::ptrdiff_t>(i), edges.end(), edges[i]) -
        edges.begin();
    if (static_cast<std::size_t>(next) == i + 1) rim.push_back(edges[i]);
    i = static_cast<std::size_t>(next);
  }
  return rim;
}

/// Moves each corner of the rim halfway to the mean of its neighbours on the rim.
void smoothRim(ReliefMesh& mesh, const std::vector<Edge>& rim) {
  std::vector<Vec3> sum_mm(mesh.corners.size(), Vec3::Zero());
  std::vector<int> count(mesh.corners.size(), 0);
  const auto add = [&](int corner, int neighbour) {
    const auto at = static_cast<std::size_t>(corner);
    sum_mm[at] += mesh.corners[static_cast<std::size_t>(neighbour)].position_mm;
    ++count[at];
  };
  for (const auto& [a, b] : rim) {
    add(a, b);
    add(b, a);
  }
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    if (count[i] == 0) continue;
    Vec3& position_mm = mesh.corners[i].position_mm;
    position_mm = 0.5 * (position_mm + sum_mm[i] / count[i]);
  }
}

}  // namespace

ReliefMesh cutWalls(ReliefMesh mesh) {
  constexpr int kSmoothings = 6;  // chosen: no step of a cell remains visible
  std::erase_if(mesh.cells, [&mesh](const auto& cell) { return isWall(mesh, cell); });
  const std::vector<Edge> rim = findRim(mesh);
  for (int i = 0; i < kSmoothings; ++i) smoothRim(mesh, rim);
  return mesh;
}

}  // namespace hapticast::client
