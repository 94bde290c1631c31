// SPDX-License-Identifier: MIT
#include "server/vision/surface/layer_cutter.hpp"

#include <gtest/gtest.h>

#include "common/wire_limits.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

constexpr double kStep_mm = 30;  // 3 mm nominal where 300 mm of depth are 30 mm
const cv::Rect kHand(60, 50, 40, 50);

// A body, 160 x 140 px, bulging a little; every rectangle lies `nearer_mm` before it.
Surface body(const std::vector<cv::Rect>& hands, double nearer_mm) {
  Surface out;
  out.box = {80, 40, 160, 140};
  out.mask = cv::Mat(out.box.size(), CV_8UC1, cv::Scalar(255));
  out.measured = out.mask.clone();
  out.depth.create(out.box.size(), CV_32FC1);
  for (int v = 0; v < out.box.height; ++v) {
    for (int u = 0; u < out.box.width; ++u)
      out.depth.at<float>(v, u) = static_cast<float>(800 + 0.4 * u + 0.2 * std::abs(v - 70));
  }
  for (const cv::Rect& hand : hands) out.depth(hand) -= nearer_mm;
  return out;
}

cv::Mat noise(const cv::Size& size, double sigma, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat out(size, CV_32FC1);
  random.fill(out, cv::RNG::NORMAL, 0, sigma);
  return out;
}

int computePixelRect(const Layers& layers, int layer) {
  return cv::countNonZero(layers.labels == layer + 1);
}

TEST(Layers, AnIsolatedPartWithoutASeedGetsTheLabelOfItsDepth) {
  Surface surface = body({kHand}, 100);
  surface.mask.colRange(140, 150).setTo(0);
  surface.depth.colRange(150, 155) -= 100.0;
  cv::Mat seeds = cv::Mat::zeros(surface.box.size(), CV_8UC1);
  seeds.colRange(0, 140).setTo(2);
  seeds(kHand).setTo(1);
  const cv::Mat labels = growLabels(surface, 2, seeds);
  EXPECT_EQ(cv::countNonZero(labels.colRange(150, 155) == 1), 5 * surface.box.height);
  EXPECT_EQ(cv::countNonZero(labels.colRange(155, 160) == 2), 5 * surface.box.height);
}

TEST(Layers, WithoutStepsThereIsOne) {
  EXPECT_EQ(findLayers(body({}, 0), kStep_mm).count, 1);
  Surface noisy = body({}, 0);
  noisy.depth += noise(noisy.box.size(), 3.0, 1);
  EXPECT_EQ(findLayers(noisy, kStep_mm).count, 1);
  // 10 mm nominal over 8 px is a slope, however steep.
  Surface ramp = body({}, 0);
  for (int u = 70; u < 160; ++u) ramp.depth.col(u) += std::min(100.0, 12.5 * (u - 70));
  EXPECT_EQ(findLayers(ramp, kStep_mm).count, 1);
  LayerCutter cutter;
  const Surface whole = body({}, 0);
  const std::vector<Surface> same = cutter.cut(whole, kStep_mm);
  ASSERT_EQ(same.size(), 1U);
  EXPECT_EQ(same[0].depth.data, whole.depth.data);
}

TEST(Layers, AStepOfTenMillimetresCutsTheObjectInTwo) {
  Surface surface = body({kHand}, 100);
  surface.depth += noise(surface.box.size(), 2.0, 2);
  const Layers layers = findLayers(surface, kStep_mm);
  ASSERT_EQ(layers.count, 2);
  EXPECT_EQ(computePixelRect(layers, 0), kHand.area());
  EXPECT_EQ(cv::countNonZero(layers.labels(kHand) == 1), kHand.area());
  EXPECT_EQ(computePixelRect(layers, 1), surface.box.area() - kHand.area());
}

TEST(Layers, AStepSmearedByTheSensorCutsToo) {
  Surface surface = body({kHand}, 100);
  cv::blur(surface.depth, surface.depth, {3, 3});
  const Layers layers = findLayers(surface, kStep_mm);
  ASSERT_EQ(layers.count, 2);
  EXPECT_NEAR(computePixelRect(layers, 0), kHand.area(), 2 * (kHand.width + kHand.height));
}

TEST(Layers, TwoHandsShareALayerBehindTheHeldObject) {
  const cv::Rect other(110, 40, 30, 60);
  const Layers layers = findLayers(body({kHand, other}, 100), kStep_mm);
  ASSERT_EQ(layers.count, 2);
  EXPECT_EQ(computePixelRect(layers, 0), kHand.area() + other.area());
  const cv::Rect held(65, 60, 24, 24);
  const Layers three = findLayers(body({kHand, other, held}, 100), kStep_mm);
  ASSERT_EQ(three.count, 3);
  EXPECT_EQ(cv::countNonZero(three.labels(held) == 1), held.area());
  EXPECT_EQ(cv::countNonZero(three.labels(other) == 1), other.area());
}

TEST(Layers, SmallPiecesStayWithTheirNeighbour) {
  EXPECT_EQ(findLayers(body({{60, 60, 9, 9}}, 100), kStep_mm).count, 1);    // 81 px
  EXPECT_EQ(findLayers(body({{60, 60, 18, 20}}, 100), kStep_mm).count, 1);  // 1.6 %
  EXPECT_EQ(findLayers(body({{60, 60, 26, 26}}, 100), kStep_mm).count, 2);  // 3 %
}

TEST(Layers, PartsThatDoNotTouchAreNoLayers) {
  Surface surface = body({}, 0);
  surface.mask.colRange(70, 80).setTo(0);
  surface.depth.colRange(80, 160) += 100.0;
  EXPECT_EQ(findLayers(surface, kStep_mm).count, 1);
}

// Layers that are there; one that has gone has an empty box.
std::size_t present(const std::vector<Surface>& layers) {
  return static_cast<std::size_t>(std::count_if(
      layers.begin(), layers.end(), [](const Surface& layer) { return !layer.box.empty(); }));
}

TEST(Layers, TheirNumberDoesNotFlicker) {
  LayerCutter cutter;
  std::vector<std::size_t> counts;
  for (int i = 0; i < 60; ++i) {
    // From frame 6 on a step that noise lifts above what is needed now and then.
    const double step = i < 6 ? 0 : (i < 40 ? (i % 4 == 0 ? 20.0 : 34.0) : 0.0);
    counts.push_back(present(cutter.cut(body({kHand}, step), kStep_mm)));
  }
  // It begins once and ends once.
  const auto begin = std::find(counts.begin(), counts.end(), 2U);
  const auto end = std::find(begin, counts.end(), 1U);
  EXPECT_GE(begin - counts.begin(), 11);
  EXPECT_LT(begin - counts.begin(), 40);
  EXPECT_GE(end - counts.begin(), 42);
  ASSERT_LT(end - counts.begin(), 55);
  EXPECT_EQ(std::count(end, counts.end(), 1U), counts.end() - end);
}

TEST(Layers, AFrameWithoutTheStepKeepsTheCutWhereTheObjectIsNow) {
  LayerCutter cutter;
  (void)cutter.cut(body({kHand}, 100), kStep_mm);
  Surface flat = body({}, 0);
  flat.box += cv::Point(7, 3);
  const std::vector<Surface> parts = cutter.cut(flat, kStep_mm);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].box, kHand + flat.box.tl());
  for (int i = 0; i < 7; ++i) EXPECT_EQ(present(cutter.cut(flat, kStep_mm)), 2U) << i;
  EXPECT_EQ(present(cutter.cut(flat, kStep_mm)), 1U);
}

// Through all of vision: a ball with a box of 40 x 40 px 100 mm before it, both one mask.
std::vector<VisionResult> run(const VisionSettings& settings) {
  const test::BallScene scene{.radius_px = 70};
  Vision vision(scene.info(), settings);
  std::vector<VisionResult> out;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const double u = 140 + 2.0 * double(i);
    RgbdFrame frame = scene.frame(i, u, 120);
    frame.depth(cv::Rect(int(u) - 20, 100, 40, 40)).setTo(610);
    if (auto result = vision.push(frame, mediaTime(double(i) / 25))) out.push_back(*result);
  }
  for (VisionResult& result : vision.flush()) out.push_back(result);
  return out;
}

TEST(Layers, AreObjectsOfOneIdThatMoveAlike) {
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  for (const VisionResult& result : run(settings)) {
    ASSERT_EQ(result.frame.objects.size(), 2U);
    const HapticObject& front = result.frame.objects[0];
    const HapticObject& back = result.frame.objects[1];
    EXPECT_EQ(front.id, back.id);
    EXPECT_EQ(front.layer, 0U);
    EXPECT_EQ(back.layer, 1U);
    EXPECT_EQ(front.motion.position_mm, back.motion.position_mm);
    EXPECT_EQ(front.motion.velocity_mm_s, back.motion.velocity_mm_s);
    EXPECT_EQ(front.relief->rect.width, 40);
    // No slope where there is a gap: the box is flat to its edge, nothing behind it is pulled up.
    for (const float height : front.relief->height_mm) EXPECT_NEAR(height, 29.0F, 0.01F);
    for (const float height : back.relief->height_mm) EXPECT_LT(height, 20.1F);
  }
}

// Rings around one point, each nearer than the one around it: boxes as large as the picture.
TEST(Layers, AFrameHasNoMoreOfThemThanAClientTakes) {
  SourceInfo info;
  info.width_px = 1920;
  info.height_px = 1080;
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  Vision vision(info, settings);
  RgbdFrame frame;
  frame.color = cv::Mat(1080, 1920, CV_8UC3, cv::Scalar(80, 90, 100));
  frame.depth.create(1080, 1920, CV_32FC1);
  for (int v = 0; v < 1080; ++v) frame.depth.row(v).setTo(860 + 0.02 * v);
  frame.mask = cv::Mat(1080, 1920, CV_8UC1, cv::Scalar(1));
  for (int i = 1; i < 4; ++i) {
    const int inset_px = 12 * i;
    frame.depth(cv::Rect(inset_px, inset_px, 1920 - 2 * inset_px, 1080 - 2 * inset_px)) -= 60.0;
  }
  (void)vision.push(frame, mediaTime(0));
  const std::vector<VisionResult> results = vision.flush();
  ASSERT_EQ(results.size(), 1U);
  std::size_t pixels = 0;
  for (const HapticObject& object : results[0].frame.objects)
    pixels += std::size_t(object.relief->rect.width) * std::size_t(object.relief->rect.height);
  EXPECT_EQ(results[0].frame.objects.size(), 2U);
  EXPECT_LE(pixels, kMaxReliefPixels);
}

TEST(Layers, TheThesisHasNone) {
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  settings.method = Method::kThesis;
  settings.segment = SegmentMode::kSource;
  for (const VisionResult& result : run(settings)) EXPECT_EQ(result.frame.objects.size(), 1U);
}

}  // namespace
}  // namespace hapticast::server
