// SPDX-License-Identifier: MIT
#include "common/relief/height_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace hapticast {
namespace {

using HeightAt = std::function<double(const Vec2&)>;  // nominal mm -> mm
using MaskAt = std::function<bool(const Vec2&)>;      // px

/// Heights of `height` at the pixel centres, also where the mask is 0 (they must not be used).
Relief makeRelief(const PixelRect& rect, const Workspace& workspace, const HeightAt& height,
                  const MaskAt& mask) {
  Relief relief;
  relief.rect = rect;
  for (int v = rect.v; v < rect.v + rect.height; ++v) {
    for (int u = rect.u; u < rect.u + rect.width; ++u) {
      const Vec2 centre(u + 0.5, v + 0.5);
      const bool covered = mask(centre);
      relief.mask.push_back(covered ? 1 : 0);
      relief.height_mm.push_back(covered ? static_cast<float>(height(workspace.toNominal(centre)))
                                         : 99.0F);
    }
  }
  return relief;
}

bool everywhere(const Vec2&) { return true; }

struct PlaneCase {
  Workspace workspace;
  double slope_x;
  double slope_y;
};

class Planes : public ::testing::TestWithParam<PlaneCase> {};

TEST_P(Planes, ValueAndGradientAreExactBetweenPixels) {
  const PlaneCase& p = GetParam();
  const auto plane = [&](const Vec2& at) { return 10.0 + p.slope_x * at.x() + p.slope_y * at.y(); };
  const Relief relief = makeRelief({300, 200, 40, 30}, p.workspace, plane, everywhere);
  const HeightField field = HeightField::prepare(relief, p.workspace);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(300.0, 340.0);
  std::uniform_real_distribution<double> v(200.0, 230.0);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 px(u(random), v(random));
    const double truth = plane(p.workspace.toNominal(px));
    for (const SurfaceSample& sample : {field.bilinear(px), SurfaceSample(field.spline(px))}) {
      EXPECT_NEAR(sample.height_mm, truth, 1e-5);
      EXPECT_NEAR(sample.gradient.x(), p.slope_x, 1e-4);
      EXPECT_NEAR(sample.gradient.y(), p.slope_y, 1e-4);  // y up, though v runs down
    }
  }
}

Workspace stretched() {
  Workspace workspace;
  workspace.width_px = 1920;
  workspace.height_px = 1080;
  workspace.stretch = true;
  return workspace;
}

INSTANTIATE_TEST_SUITE_P(HeightField, Planes,
                         ::testing::Values(PlaneCase{{}, 1.0 / 16, 0.0},
                                           PlaneCase{{}, 0.0, 1.0 / 16}, PlaneCase{{}, -0.2, 0.3},
                                           PlaneCase{stretched(), 0.25, -0.15}));

TEST(HeightField, BilinearWeightsAreTheOppositeAreas) {
  // h = x and h = y in px; own-area or swapped weights miss both.
  Workspace workspace;
  workspace.width_mm = 640.0;
  workspace.height_mm = 480.0;
  for (const int axis : {0, 1}) {
    const auto ramp = [axis](const Vec2& at) { return at[axis]; };
    const Relief relief = makeRelief({310, 230, 20, 20}, workspace, ramp, everywhere);
    const HeightField field = HeightField::prepareThesis(relief, workspace);
    for (double a = 0.05; a < 1.0; a += 0.1) {
      for (double b = 0.05; b < 1.0; b += 0.1) {
        const Vec2 px(319.5 + a, 239.5 + b);
        EXPECT_NEAR(field.bilinear(px).height_mm, workspace.toNominal(px)[axis], 1e-5);
      }
    }
  }
}

TEST(HeightField, GradientAtAPixelCentreIsSobel) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> height(0.0, 30.0);
  const Workspace workspace;
  const Relief relief = makeRelief(
      {10, 20, 9, 9}, workspace, [&](const Vec2&) { return height(random); }, everywhere);
  const HeightField field = HeightField::prepare(relief, workspace);
  const auto h = [&](int u, int v) {
    return static_cast<double>(relief.height_mm[static_cast<std::size_t>(v * 9 + u)]);
  };
  const SurfaceSample sample = field.bilinear({14.5, 24.5});  // pixel (4, 4) of the rectangle
  const double per_u = (h(5, 3) + 2 * h(5, 4) + h(5, 5) - h(3, 3) - 2 * h(3, 4) - h(3, 5)) / 8.0;
  const double per_v = (h(3, 5) + 2 * h(4, 5) + h(5, 5) - h(3, 3) - 2 * h(4, 3) - h(5, 3)) / 8.0;
  EXPECT_NEAR(sample.height_mm, h(4, 4), 1e-5);
  EXPECT_NEAR(sample.gradient.x(), per_u / 0.25, 1e-4);
  EXPECT_NEAR(sample.gradient.y(), -per_v / 0.25, 1e-4);
}

/// The uniform cubic B-spline (order 0), its first and second derivative at x.
double cubicB(int order, double x) {
  const double a = std::abs(x);
  if (a >= 2.0) return 0.0;
  const double sign = x < 0.0 ? -1.0 : 1.0;
  if (a < 1.0) {
    if (order == 0) return 2.0 / 3.0 - a * a + 0.5 * a * a * a;
    return order == 1 ? sign * (-2.0 * a + 1.5 * a * a) : -2.0 + 3.0 * a;
  }
  const double b = 2.0 - a;
  if (order == 0) return b * b * b / 6.0;
  return order == 1 ? -sign * 0.5 * b * b : b;
}

TEST(HeightField, SplineIsTheSumOfItsBasis) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> height(0.0, 30.0);
  for (const Workspace& workspace : {Workspace{}, stretched()}) {
    const Relief relief = makeRelief(
        {10, 20, 9, 9}, workspace, [&](const Vec2&) { return height(random); }, everywhere);
    const HeightField field = HeightField::prepare(relief, workspace);
    std::uniform_real_distribution<double> at(2.0, 7.0);
    for (int i = 0; i < 500; ++i) {
      const Vec2 px(at(random), at(random));
      const auto sum = [&](int order_u, int order_v) {
        double total = 0.0;
        for (int v = 0; v < 9; ++v) {
          for (int u = 0; u < 9; ++u) {
            total += cubicB(order_u, px.x() - u - 0.5) * cubicB(order_v, px.y() - v - 0.5) *
                     static_cast<double>(relief.height_mm[static_cast<std::size_t>(v * 9 + u)]);
          }
        }
        return total;
      };
      const CurvedSample sample = field.spline(px + Vec2(10.0, 20.0));
      const Vec2 mm = workspace.mmPerPixel();
      EXPECT_NEAR(sample.height_mm, sum(0, 0), 2e-5);
      EXPECT_NEAR(sample.gradient.x(), sum(1, 0) / mm.x(), 5e-4);
      EXPECT_NEAR(sample.gradient.y(), -sum(0, 1) / mm.y(), 5e-4);
      EXPECT_NEAR(sample.bend_xx, sum(2, 0) / mm.x() / mm.x(), 1e-2);
      EXPECT_NEAR(sample.bend_xy, -sum(1, 1) / mm.x() / mm.y(), 1e-2);
      EXPECT_NEAR(sample.bend_yy, sum(0, 2) / mm.y() / mm.y(), 1e-2);
      EXPECT_LE(sample.height_mm, field.highest_mm());
    }
  }
}

TEST(HeightField, EdgeGradientIsTheDerivativeOfTheDistance) {
  const Workspace workspace;
  const auto disc = [&](const Vec2& px) { return (px - Vec2(320, 240)).norm() < 30.0; };
  const HeightField field = HeightField::prepare(
      makeRelief(
          {288, 208, 64, 64}, workspace, [](const Vec2&) { return 5.0; }, disc),
      workspace);
  const double eps = 0.01;
  double steepest = 0.0;
  for (double angle = 0.0; angle < 6.28; angle += 0.03) {
    for (double r = 20.0; r < 40.0; r += 0.7) {
      const Vec2 px = Vec2(320, 240) + r * Vec2(std::cos(angle), std::sin(angle));
      const auto along = [&](const Vec2& step) {
        return (field.edge(px + step).distance_mm - field.edge(px - step).distance_mm) /
               (2.0 * eps * 0.25);
      };
      const Vec2 gradient = field.edge(px).gradient;
      EXPECT_NEAR(gradient.x(), along({eps, 0.0}), 2e-3);
      EXPECT_NEAR(gradient.y(), -along({0.0, eps}), 2e-3);
      steepest = std::max(steepest, gradient.norm());
    }
  }
  EXPECT_LT(steepest, 1.1);  // what lets the proxy do without samples far from the edge
}

TEST(HeightField, ContinuesAPlaneBeyondADiscExactly) {
  const Workspace workspace;
  const auto plane = [](const Vec2& at) { return 12.0 + 0.3 * at.x() - 0.25 * at.y(); };
  const Vec2 centre(320.0, 240.0);
  const auto disc = [&](const Vec2& px) { return (px - centre).norm() < 30.0; };
  const HeightField field =
      HeightField::prepare(makeRelief({288, 208, 64, 64}, workspace, plane, disc), workspace);
  double worst = 0.0;
  for (double angle = 0.0; angle < 6.28; angle += 0.05) {
    for (double r = 0.0; r < 41.0; r += 0.7) {
      const Vec2 px = centre + r * Vec2(std::cos(angle), std::sin(angle));
      worst =
          std::max(worst, std::abs(field.bilinear(px).height_mm - plane(workspace.toNominal(px))));
    }
  }
  EXPECT_LT(worst, 1e-3);
}

TEST(HeightField, FillsAHoleOfAPlaneExactly) {
  const Workspace workspace;
  const auto plane = [](const Vec2& at) { return 12.0 + 0.3 * at.x() - 0.25 * at.y(); };
  const auto holed = [](const Vec2& px) { return (px - Vec2(320, 240)).norm() > 8.0; };
  const HeightField field =
      HeightField::prepare(makeRelief({290, 210, 60, 60}, workspace, plane, holed), workspace);
  for (int i = -6; i <= 6; ++i) {
    const Vec2 px(320.0 + i, 240.0 + 0.5 * i);
    EXPECT_FALSE(field.inside(px));
    EXPECT_NEAR(field.bilinear(px).height_mm, plane(workspace.toNominal(px)), 1e-3);
  }
}

/// Errors of the continuation of a sphere of 20 mm that is cut off at 10 mm from its axis.
TEST(HeightField, ContinuesASphereClosely) {
  const Workspace workspace;
  const auto sphere = [](const Vec2& at) {
    return std::sqrt(std::max(0.0, 400.0 - at.squaredNorm()));
  };
  const auto cap = [](const Vec2& px) { return (px - Vec2(320, 240)).norm() < 40.0; };
  const HeightField field =
      HeightField::prepare(makeRelief({280, 200, 80, 80}, workspace, sphere, cap), workspace);
  double near = 0.0;
  double far = 0.0;
  double slope = 0.0;
  for (double angle = 0.0; angle < 6.28; angle += 0.02) {
    const Vec2 direction(std::cos(angle), std::sin(angle));
    for (double r = 40.0; r < 52.0; r += 0.5) {
      const Vec2 px = Vec2(320, 240) + r * direction;
      const double error = std::abs(field.bilinear(px).height_mm - sphere(workspace.toNominal(px)));
      (r < 43.0 ? near : far) = std::max(r < 43.0 ? near : far, error);
    }
    const Vec2 rim = Vec2(320, 240) + 39.0 * direction;
    const Vec2 at = workspace.toNominal(rim);
    slope = std::max(slope, (field.spline(rim).gradient + at / sphere(at)).norm());
  }
  EXPECT_LT(near, 0.02);
  EXPECT_LT(far, 0.5);
  EXPECT_LT(slope, 0.02);
}

TEST(HeightField, ContinuationStaysNearTheLocalMean) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> height(14.0, 16.0);
  std::bernoulli_distribution covered(0.5);
  const Workspace workspace;
  for (int trial = 0; trial < 20; ++trial) {
    const HeightField field = HeightField::prepare(
        makeRelief(
            {5, 5, 24, 20}, workspace, [&](const Vec2&) { return height(random); },
            [&](const Vec2&) { return covered(random); }),
        workspace);
    for (double v = -10.0; v < 45.0; v += 0.9) {
      for (double u = -10.0; u < 45.0; u += 0.9) {
        const SurfaceSample sample = field.bilinear({u, v});
        ASSERT_GE(sample.height_mm, 12.0 - 1e-6);
        ASSERT_LE(sample.height_mm, 18.0 + 1e-6);
      }
    }
  }
}

TEST(HeightField, EdgeDistanceOfAHalfPlaneAndADisc) {
  const Workspace workspace;
  const auto flat = [](const Vec2&) { return 5.0; };
  const auto left = [](const Vec2& px) { return px.x() < 320.0; };
  const HeightField half =
      HeightField::prepare(makeRelief({280, 180, 80, 120}, workspace, flat, left), workspace);
  for (double d = -6.0; d <= 6.0; d += 0.37) {
    EXPECT_NEAR(half.edge({320.0 - d, 240.0}).distance_mm, 0.25 * d, 0.02) << d;
  }
  EXPECT_NEAR(half.edge({285.0, 240.0}).distance_mm, 1.25, 0.02);  // 5 px inside the left rim
  EXPECT_NEAR(half.edge({302.0, 240.0}).distance_mm, 3.0, 0.1);    // clamped to 12 px
  EXPECT_NEAR(half.edge({9000.0, -9000.0}).distance_mm, -3.0, 0.1);

  const auto disc = [](const Vec2& px) { return (px - Vec2(320, 240)).norm() < 40.0; };
  const HeightField round =
      HeightField::prepare(makeRelief({280, 200, 80, 80}, workspace, flat, disc), workspace);
  double worst = 0.0;
  for (double angle = 0.0; angle < 6.28; angle += 0.01) {
    for (double d = -4.0; d <= 4.0; d += 0.5) {
      const Vec2 px = Vec2(320, 240) + (40.0 - d) * Vec2(std::cos(angle), std::sin(angle));
      worst = std::max(worst, std::abs(round.edge(px).distance_mm - 0.25 * d));
    }
  }
  EXPECT_LT(worst, 0.12);  // half a pixel: the mask itself is no better
}

TEST(HeightField, ThesisIsZeroOutsideTheMask) {
  const Workspace workspace;
  const auto disc = [](const Vec2& px) { return (px - Vec2(320, 240)).norm() < 10.0; };
  const auto flat = [](const Vec2&) { return 5.0; };
  const HeightField field =
      HeightField::prepareThesis(makeRelief({305, 225, 30, 30}, workspace, flat, disc), workspace);
  EXPECT_NEAR(field.bilinear({320, 240}).height_mm, 5.0, 1e-6);
  EXPECT_EQ(field.bilinear({333, 240}).height_mm, 0.0);
  EXPECT_LT(field.bilinear({329.5, 240}).gradient.x(), -1.0);  // the silhouette is a cliff
  EXPECT_GT(field.edge({320, 240}).distance_mm, 1.5);  // 2.5 mm, the tip of the cone blurred
}

TEST(HeightField, InsideIsThePixelUnderThePoint) {
  const Workspace workspace;
  const auto checks = [](const Vec2& px) {
    return (static_cast<int>(px.x()) + static_cast<int>(px.y())) % 2 == 0;
  };
  const auto flat = [](const Vec2&) { return 1.0; };
  const HeightField field =
      HeightField::prepare(makeRelief({0, 0, 6, 6}, workspace, flat, checks), workspace);
  EXPECT_TRUE(field.inside({2.0, 2.0}));
  EXPECT_TRUE(field.inside({2.99, 2.99}));
  EXPECT_FALSE(field.inside({3.0, 2.5}));
  EXPECT_FALSE(field.inside({-0.01, 0.5}));
  EXPECT_FALSE(field.inside({6.0, 4.0}));
  EXPECT_FALSE(field.inside({1e300, 0.0}));
}

TEST(HeightField, TinyEmptyAndFullMasks) {
  const Workspace workspace;
  const auto flat = [](const Vec2&) { return 7.0; };
  const HeightField pixel =
      HeightField::prepare(makeRelief({0, 0, 1, 1}, workspace, flat, everywhere), workspace);
  EXPECT_TRUE(pixel.inside({0.5, 0.5}));
  for (double u = -20.0; u < 20.0; u += 0.77) {
    EXPECT_NEAR(pixel.bilinear({u, 0.3 * u}).height_mm, 7.0, 1e-5);
    EXPECT_NEAR(pixel.bilinear({u, 0.3 * u}).gradient.norm(), 0.0, 1e-4);
  }
  const HeightField nothing = HeightField::prepare(
      makeRelief({3, 3, 5, 5}, workspace, flat, [](const Vec2&) { return false; }), workspace);
  EXPECT_FALSE(nothing.inside({5.5, 5.5}));
  EXPECT_EQ(nothing.bilinear({5.5, 5.5}).height_mm, 0.0);
  EXPECT_NEAR(nothing.edge({5.5, 5.5}).distance_mm, -3.0, 1e-5);
  Relief mismatched;
  mismatched.rect = {0, 0, 4, 4};
  for (const HeightField& field : {HeightField{}, HeightField::prepare(mismatched, workspace)}) {
    EXPECT_TRUE(field.empty());
    EXPECT_FALSE(field.inside({0, 0}));
  }
}

TEST(HeightField, AnyCoordinateIsSafe) {
  const Workspace workspace;
  const HeightField field = HeightField::prepare(
      makeRelief(
          {4, 4, 10, 10}, workspace, [](const Vec2& at) { return 5.0 + 0.1 * at.x(); }, everywhere),
      workspace);
  constexpr double kInf = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double u : {-1e308, -1e9, -0.0, 3.0, 1e9, 1e308, kInf, -kInf, kNan}) {
    for (const double v : {-1e308, 0.0, 7.7, 1e308, kInf, kNan}) {
      const Vec2 px(u, v);
      EXPECT_TRUE(std::isfinite(field.bilinear(px).height_mm));
      EXPECT_TRUE(field.bilinear(px).gradient.allFinite());
      EXPECT_TRUE(std::isfinite(field.spline(px).height_mm));
      EXPECT_TRUE(std::isfinite(field.edge(px).distance_mm));
      EXPECT_TRUE(px.allFinite() || !field.inside(px));
    }
  }
}

}  // namespace
}  // namespace hapticast
