// SPDX-License-Identifier: MIT
// Means of reliefs over time: less noise where the surface moves as its motion says, and nothing
// else anywhere.
#include "server/vision/offline/relief_fusion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace hapticast::server {
namespace {

constexpr int kFrames = 40;
constexpr PixelRect kRect{200, 150, 60, 50};

// Seen from far away, so that the picture is a parallel projection.
const FusionView kView{Workspace{}, {1e6 - 120.0, 1e6}, {1e6, 1e6, 320.0, 240.0}};

/// Height over a place of the body (px of the relief) in a frame.
using Height = std::function<double(double u, double v, int frame)>;

/// Returns the pixel of a number in the body's relief, whose width all reliefs have.
Vec2 findPixel(std::size_t at) {
  const auto width = static_cast<std::size_t>(kRect.width);
  const std::size_t column = at % width, row = at / width;
  return {static_cast<double>(column), static_cast<double>(row)};
}

/// Returns clips of a square body that moves `step_px` to the right in each frame.
std::vector<VisionResult> makeClip(const Height& height, int step_px, double noise_mm) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, noise_mm);
  std::vector<VisionResult> clip;
  for (int i = 0; i < kFrames; ++i) {
    PixelRect rect = kRect;
    rect.u += step_px * i;
    auto relief = std::make_shared<Relief>(Relief::blank(rect));
    for (std::size_t at = 0; at < rect.pixels(); ++at) {
      const Vec2 uv = findPixel(at);
      relief->mask[at] = 1;
      relief->height_mm[at] =
          static_cast<float>(height(uv.x(), uv.y(), i) + (noise_mm > 0 ? noise(random) : 0.0));
    }
    VisionResult result;
    result.frame.id = static_cast<std::uint64_t>(i) + 1;
    result.frame.objects.emplace_back();
    HapticObject& object = result.frame.objects.back();
    object.id = 1;
    object.relief = relief;
    object.changed_in_frame = result.frame.id;
    object.motion.position_mm = {step_px * i * 0.25, 0.0, 0.0};
    result.measured.push_back(relief);
    clip.push_back(std::move(result));
  }
  return clip;
}

std::vector<VisionResult> fuse(const std::vector<VisionResult>& clip) {
  ReliefFusion fusion(kView);
  std::vector<VisionResult> out;
  for (const VisionResult& result : clip) {
    fusion.push(result);
    while (auto fused = fusion.next(false)) out.push_back(std::move(*fused));
  }
  while (auto fused = fusion.next(true)) out.push_back(std::move(*fused));
  return out;
}

/// Returns the rms error of all heights, mm.
double reliefErrorOf(const std::vector<VisionResult>& clip, const Height& truth) {
  double square = 0;
  double count = 0;
  for (int i = 0; i < kFrames; ++i) {
    const Relief& relief = *clip[static_cast<std::size_t>(i)].frame.objects[0].relief;
    for (std::size_t at = 0; at < relief.height_mm.size(); ++at) {
      const Vec2 uv = findPixel(at);
      square += std::pow(relief.height_mm[at] - truth(uv.x(), uv.y(), i), 2);
      count += 1;
    }
  }
  return std::sqrt(square / count);
}

TEST(ReliefFusionTest, NoiseOfARigidBodyFalls) {
  const Height hill = [](double u, double v, int) {
    return 10 + 3 * std::sin(u / 9) * std::cos(v / 7);
  };
  for (const int step_px : {0, 3}) {
    const auto clip = makeClip(hill, step_px, 0.2);
    const auto fused = fuse(clip);
    ASSERT_EQ(fused.size(), clip.size());
    EXPECT_LT(reliefErrorOf(fused, hill), 0.55 * reliefErrorOf(clip, hill)) << step_px;
  }
}

TEST(ReliefFusionTest, ASurfaceThatDeformsKeepsItsHeights) {
  const Height swing = [](double u, double v, int frame) {
    return 10 + std::sin(0.25 * frame) * std::sin(u / 9) * std::cos(v / 7);
  };
  const auto clip = makeClip(swing, 0, 0.0);
  EXPECT_LT(reliefErrorOf(fuse(clip), swing), 0.01);
}

TEST(ReliefFusionTest, FramesThatAreNotWantedKeepTheirReliefs) {
  const auto clip = makeClip([](double, double, int) { return 10.0; }, 0, 0.2);
  ReliefFusion fusion(kView);
  for (const VisionResult& result : clip) fusion.push(result);
  for (const VisionResult& result : clip) {
    const auto out = fusion.next(true, false);
    ASSERT_TRUE(out);
    EXPECT_EQ(out->frame.objects[0].relief, result.frame.objects[0].relief);
  }
  EXPECT_FALSE(fusion.next(true));
}

}  // namespace
}  // namespace hapticast::server
