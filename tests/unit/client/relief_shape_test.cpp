// SPDX-License-Identifier: MIT
#include "client/view/relief_shape.hpp"

#include <gtest/gtest.h>

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
