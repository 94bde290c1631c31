// SPDX-License-Identifier: MIT
#include "client/view/relief_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/support/flat_relief.hpp"

namespace hapticast::client {
namespace {

std::shared_ptr<const HeightField> fieldOf(const Relief& relief, const Workspace& workspace) {
  return std::make_shared<const HeightField>(HeightField::prepare(relief, workspace));
}

TEST(ReliefShape, TheOutlineFollowsTheMaskAndItsHoles) {
  auto relief = flatRelief({100, 50, 60, 40});
  for (int v = 10; v < 20; ++v) {
    for (int u = 20; u < 40; ++u) relief->mask[static_cast<std::size_t>(v * 60 + u)] = 0;
  }
  const auto lines = traceOutline(*fieldOf(*relief, Workspace{}));
  ASSERT_EQ(lines.size(), 2U);
  const auto spans = [&](const cv::Rect2f& wanted) {
    return std::any_of(lines.begin(), lines.end(), [&](const auto& line) {
      float left = 1e9F, top = 1e9F, right = 0.0F, bottom = 0.0F;
      for (const cv::Point2f& point : line) {
        left = std::min(left, point.x);
        right = std::max(right, point.x);
        top = std::min(top, point.y);
        bottom = std::max(bottom, point.y);
      }
      return std::abs(left - wanted.x) < 1.1F && std::abs(top - wanted.y) < 1.1F &&
             std::abs(right - wanted.x - wanted.width) < 1.1F &&
             std::abs(bottom - wanted.y - wanted.height) < 1.1F;
    });
  };
  EXPECT_TRUE(spans({100, 50, 60, 40}));
  EXPECT_TRUE(spans({120, 60, 20, 10}));
}

TEST(ReliefShape, TheMeshIsTheSurface) {
  const Workspace workspace;
  const auto field = fieldOf(*flatRelief({300, 200, 41, 41}, 7.0F), workspace);
  const ReliefMesh mesh = buildMesh({field}, workspace);
  EXPECT_EQ(mesh.cells.size(), 1600U);
  for (const ReliefMesh::Corner& corner : mesh.corners) {
    EXPECT_NEAR(corner.position_mm.z(), 7.0, 1e-4);
    const Vec2 px = workspace.toImage(corner.position_mm.head<2>());
    EXPECT_TRUE(field->inside(px)) << px.transpose();
    EXPECT_NEAR(corner.light, mesh.corners.front().light, 1e-6) << "flat: lit alike";
  }
}

TEST(ReliefShape, CutOffSidesAreWalls) {
  const Workspace workspace;  // 0.25 mm per px
  auto relief = flatRelief({300, 200, 41, 41}, 20.0F);
  for (std::size_t v = 0; v < 41; ++v) relief->height_mm[v * 41 + 40] = 3.0F;  // its right side
  for (std::size_t v = 0; v < 41; ++v) relief->height_mm[v * 41] = 19.5F;      // a slope
  const ReliefMesh mesh = buildMesh({fieldOf(*relief, workspace)}, workspace);
  std::size_t walls = 0;
  for (const auto& cell : mesh.cells) {
    if (!isWall(mesh, cell)) continue;
    ++walls;
    EXPECT_GT(
        workspace.toImage(mesh.corners[static_cast<std::size_t>(cell[1])].position_mm.head<2>())
            .x(),
        338.0);
  }
  EXPECT_EQ(walls, 40U);
  EXPECT_EQ(cutWalls(mesh).cells.size(), mesh.cells.size() - walls);
}

/// Difference between the rows of a mesh in how far they extend to the right, mm. The outermost
/// rows do not count.
double raggedness_mm(const ReliefMesh& mesh) {
  std::map<int, double> right_mm;  // by row of about 0.25 mm
  for (const auto& cell : mesh.cells) {
    for (const int corner : cell) {
      const Vec3& at_mm = mesh.corners[static_cast<std::size_t>(corner)].position_mm;
      const int row = static_cast<int>(std::lround(4.0 * at_mm.y()));
      const auto [known, added] = right_mm.try_emplace(row, at_mm.x());
      if (!added) known->second = std::max(known->second, at_mm.x());
    }
  }
  double low_mm = 1e9, high_mm = -1e9;
  for (const auto& [row, x_mm] : right_mm) {
    if (row - right_mm.begin()->first < 8 || right_mm.rbegin()->first - row < 8) continue;
    low_mm = std::min(low_mm, x_mm);
    high_mm = std::max(high_mm, x_mm);
  }
  return high_mm - low_mm;
}

TEST(ReliefShape, TheRimWithoutWallsIsSmooth) {
  const Workspace workspace;
  auto relief = flatRelief({300, 200, 41, 41}, 20.0F);
  for (std::size_t v = 0; v < 41; ++v) {  // a ragged side: steps of two pixels
    for (std::size_t u = v / 2 % 2 == 0 ? 37 : 39; u < 41; ++u)
      relief->height_mm[v * 41 + u] = 3.0F;
  }
  ReliefMesh mesh = buildMesh({fieldOf(*relief, workspace)}, workspace);
  const ReliefMesh cut = cutWalls(mesh);
  std::erase_if(mesh.cells, [&mesh](const auto& cell) { return isWall(mesh, cell); });
  // The low side beyond the wall is a part of the mesh, too.
  const auto isLow = [](const ReliefMesh& shape) {
    return [&shape](const auto& cell) {
      return shape.corners[static_cast<std::size_t>(cell[0])].position_mm.z() < 10.0;
    };
  };
  ReliefMesh high_cut = cut;
  std::erase_if(mesh.cells, isLow(mesh));
  std::erase_if(high_cut.cells, isLow(cut));
  EXPECT_GT(raggedness_mm(mesh), 0.4);
  EXPECT_LT(raggedness_mm(high_cut), 0.3);
}

TEST(ReliefShape, HoweverLargeAndManyItStaysSmall) {
  Workspace workspace;
  workspace.width_px = 1920;
  workspace.height_px = 1080;
  const auto field = fieldOf(*flatRelief({0, 0, 1920, 1080}), workspace);
  for (const std::size_t count : {1U, 2U, 16U}) {
    const ReliefMesh mesh = buildMesh(Reliefs(count, field), workspace);
    EXPECT_GT(mesh.cells.size(), 2000U) << count;
    EXPECT_LE(static_cast<double>(mesh.cells.size()), ReliefMesh::kMostCells) << count;
  }
}

}  // namespace
}  // namespace hapticast::client
