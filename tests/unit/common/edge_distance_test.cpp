// SPDX-License-Identifier: MIT
// The edge of a mask for the proxy, against the shape the mask was drawn from.
#include "common/relief/distance_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "common/relief/height_field.hpp"

namespace hapticast {
namespace {

using MaskAt = std::function<bool(const Vec2&)>;  // nominal mm

constexpr double kPi = 3.14159265358979;

constexpr Workspace kOblong{.width_px = 1920, .height_px = 1080, .stretch = true};

/// The mask of `inside`, of half a width and height of `reach_mm` about the middle of the picture.
HeightField fieldOf(const Workspace& workspace, double reach_mm, const MaskAt& inside) {
  const Vec2 corner_px = workspace.toImage({-reach_mm, reach_mm});
  const Vec2 size_px = workspace.toImage({reach_mm, -reach_mm}) - corner_px;
  Relief relief;
  relief.rect = {static_cast<int>(corner_px.x()), static_cast<int>(corner_px.y()),
                 static_cast<int>(size_px.x()) + 2, static_cast<int>(size_px.y()) + 2};
  for (int v = relief.rect.v; v < relief.rect.v + relief.rect.height; ++v) {
    for (int u = relief.rect.u; u < relief.rect.u + relief.rect.width; ++u) {
      const bool covered = inside(workspace.toNominal({u + 0.5, v + 0.5}));
      relief.mask.push_back(covered ? 1 : 0);
      relief.height_mm.push_back(covered ? 10.0F : 0.0F);
    }
  }
  return HeightField::prepare(relief, workspace);
}

Vec2 direction(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

Vec2 rotated(const Vec2& v, double angle_rad) {
  const Vec2 x = direction(angle_rad);
  return v.x() * x + v.y() * Vec2(-x.y(), x.x());
}

/// Errors of the edge along its normal (px) and of the normal's direction, over many points.
class EdgeErrors {
 public:
  void add(const HeightField& field, const Workspace& workspace, const Vec2& at_mm,
           const Vec2& outward) {
    double off_mm = 0.0;
    EdgeSample sample;
    for (int i = 0; i < 6; ++i) {
      sample = field.edge(workspace.toImage(at_mm + off_mm * outward));
      off_mm -= sample.distance_mm / sample.gradient.dot(outward);
    }
    const double off_px = off_mm / workspace.mmPerPixel().mean();
    sum_ += off_px;
    square_ += off_px * off_px;
    const Vec2 normal = -sample.gradient.normalized();
    turn_square_ += std::pow(normal.x() * outward.y() - normal.y() * outward.x(), 2.0);
    ++count_;
  }
  [[nodiscard]] double mean_px() const { return sum_ / count_; }
  [[nodiscard]] double rms_px() const { return std::sqrt(square_ / count_); }
  [[nodiscard]] double turnDeg() const { return std::sqrt(turn_square_ / count_) * 180.0 / kPi; }

 private:
  double sum_ = 0.0, square_ = 0.0, turn_square_ = 0.0;
  double count_ = 0.0;
};

/// Somewhere between pixels, mm.
Vec2 anywhere(std::mt19937& random) {
  std::uniform_real_distribution<double> within(-0.125, 0.125);
  const double x_mm = within(random);
  return {x_mm, within(random)};
}

EdgeErrors circleErrors(const Workspace& workspace, double radius_mm) {
  std::mt19937 random(1);
  EdgeErrors errors;
  for (int i = 0; i < 6; ++i) {
    const Vec2 centre_mm = anywhere(random);
    const HeightField field = fieldOf(workspace, radius_mm + 0.5, [&](const Vec2& at_mm) {
      return (at_mm - centre_mm).norm() < radius_mm;
    });
    for (double angle_rad = 0.0; angle_rad < 2.0 * kPi; angle_rad += 0.1 / radius_mm) {
      const Vec2 outward = direction(angle_rad);
      errors.add(field, workspace, centre_mm + radius_mm * outward, outward);
    }
  }
  return errors;
}

// A Gaussian alone draws circles in by 3 px² / R and follows the stretches where the mask runs
// along whole pixels: 0.175 px at R = 20 px, 0.1 px at 60, 1.5 deg.
TEST(EdgeDistance, MeasuresCirclesAtTheirPlace) {
  for (const double radius_px : {20.0, 40.0, 60.0, 120.0}) {
    const EdgeErrors errors = circleErrors(Workspace{}, 0.25 * radius_px);
    EXPECT_LT(errors.rms_px(), radius_px < 30.0 ? 0.12 : 0.085);
    EXPECT_LT(std::abs(errors.mean_px()), radius_px < 30.0 ? 0.08 : 0.05);
    EXPECT_LT(errors.turnDeg(), radius_px < 50.0 ? 1.2 : 0.6);
  }
}

TEST(EdgeDistance, MeasuresACircleInOblongPixels) {
  const EdgeErrors errors = circleErrors(kOblong, 10.0);
  EXPECT_LT(errors.rms_px(), 0.12);
  EXPECT_LT(errors.turnDeg(), 1.2);
}

/// The right and the left side of a square of 30 mm turned by `angle_rad`, from `first_mm` to
/// `last_mm` of its middle.
void addSides(EdgeErrors& errors, double angle_rad, double first_mm, double last_mm,
              const Vec2& centre_mm) {
  constexpr double kHalf_mm = 15.0;
  const Workspace workspace;
  const HeightField field = fieldOf(workspace, 1.5 * kHalf_mm, [&](const Vec2& at_mm) {
    return rotated(at_mm - centre_mm, -angle_rad).cwiseAbs().maxCoeff() < kHalf_mm;
  });
  for (double along_mm = first_mm; along_mm <= last_mm; along_mm += 0.1) {
    for (const double side : {-1.0, 1.0}) {
      errors.add(field, workspace, centre_mm + rotated({side * kHalf_mm, along_mm}, angle_rad),
                 rotated({side, 0.0}, angle_rad));
    }
  }
}

// A Gaussian alone: 0.088 px, 1.45 deg.
TEST(EdgeDistance, MeasuresStraightEdgesAtAnyAngle) {
  std::mt19937 random(2);
  EdgeErrors errors;
  for (double angle_deg = 0.0; angle_deg <= 45.0; angle_deg += 1.5) {
    addSides(errors, angle_deg * kPi / 180.0, -9.0, 9.0, anywhere(random));
  }
  EXPECT_LT(errors.rms_px(), 0.085);
  EXPECT_LT(errors.turnDeg(), 0.9);
}

// A Gaussian of 2.35 px takes 0.23 px off a side 4 px from its corner.
TEST(EdgeDistance, LeavesCornersStanding) {
  std::mt19937 random(3);
  for (const double from_corner_px : {4.0, 8.0, 16.0}) {
    EdgeErrors errors;
    const double along_mm = 15.0 - 0.25 * from_corner_px;
    for (double angle_deg = 0.5; angle_deg < 45.0; angle_deg += 2.0) {
      addSides(errors, angle_deg * kPi / 180.0, along_mm, along_mm, anywhere(random));
    }
    EXPECT_LT(std::abs(errors.mean_px()), 0.15);
  }
}

double steepest(const HeightField& field, const Workspace& workspace, double reach_mm) {
  double most = 0.0;
  for (double y_mm = -reach_mm; y_mm <= reach_mm; y_mm += 0.07) {
    for (double x_mm = -reach_mm; x_mm <= reach_mm; x_mm += 0.07) {
      const EdgeSample sample = field.edge(workspace.toImage({x_mm, y_mm}));
      EXPECT_TRUE(std::isfinite(sample.distance_mm));
      most = std::max(most, sample.gradient.norm());
    }
  }
  return most;
}

// The proxy leaves out what it cannot have reached (kSteepestEdge).
TEST(EdgeDistance, IsNowhereMuchSteeperThanADistance) {
  std::mt19937 random(4);
  std::bernoulli_distribution toss(0.5);
  const auto blobs = [&] {
    std::uniform_real_distribution<double> place(-10.0, 10.0);
    std::vector<Vec2> centres;
    for (int i = 0; i < 6; ++i) {
      const double x_mm = place(random);
      centres.emplace_back(x_mm, place(random));
    }
    return [centres](const Vec2& at_mm) {
      bool inside = false;
      for (std::size_t i = 0; i < centres.size(); ++i) {
        if ((at_mm - centres[i]).norm() < 1.0 + static_cast<double>(i)) inside = !inside;
      }
      return inside;
    };
  };
  std::vector<MaskAt> masks{[&](const Vec2&) { return toss(random); }, blobs(), blobs(), blobs()};
  for (const double width_mm : {0.25, 0.5, 1.0, 2.0, 4.0}) {
    masks.emplace_back(
        [=](const Vec2& at_mm) { return std::sin(kPi * at_mm.x() / width_mm) > 0.0; });
    masks.emplace_back(
        [=](const Vec2& at_mm) { return std::abs(at_mm.x() + 0.3 * at_mm.y()) < width_mm; });
  }
  for (const Workspace& workspace : {Workspace{}, kOblong}) {
    for (const MaskAt& mask : masks) {
      EXPECT_LT(steepest(fieldOf(workspace, 12.0, mask), workspace, 15.0), 1.2);
    }
  }
}

TEST(EdgeDistance, OnePixelAndOneRowAreSafe) {
  for (const auto& [width, height] : {std::pair{1, 1}, std::pair{40, 1}, std::pair{1, 40}}) {
    std::vector<float> distance_mm(static_cast<std::size_t>(width * height), 0.1F);
    smoothEdgeDistance(distance_mm, width, height, {0.25, 0.25});
    for (const float each_mm : distance_mm) EXPECT_NEAR(each_mm, 0.1F, 1e-6F);
  }
}

}  // namespace
}  // namespace hapticast
