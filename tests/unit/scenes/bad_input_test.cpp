// SPDX-License-Identifier: MIT
// Invalid input that some sources send: each becomes frames that can be touched, or
// as one clear line.
#include <gtest/gtest.h>

#include <limits>

#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

using test::BallScene;

std::vector<VisionResult> runAll(const SourceInfo& info, const VisionSettings& settings,
                                 std::uint64_t frames,
                                 const std::function<RgbdFrame(std::uint64_t)>& make) {
  Vision vision(info, settings);
  std::vector<VisionResult> out;
  for (std::uint64_t i = 0; i < frames; ++i) {
    if (auto result = vision.push(make(i), mediaTime(double(i) / info.fps))) out.push_back(*result);
  }
  for (VisionResult& result : vision.flush()) out.push_back(result);
  return out;
}

// Everything in it is finite and within what the stream allows.
void expectSound(const VisionResult& result) {
  for (const HapticObject& object : result.frame.objects) {
    ASSERT_NE(object.relief, nullptr);
    const Relief& relief = *object.relief;
    EXPECT_GT(relief.rect.width, 0);
    EXPECT_GT(relief.rect.height, 0);
    for (std::size_t i = 0; i < relief.height_mm.size(); ++i)
      ASSERT_TRUE(relief.height_mm[i] >= 0.0F && relief.height_mm[i] <= 30.0F);
    EXPECT_TRUE(object.motion.position_mm.allFinite());
    EXPECT_TRUE(object.motion.velocity_mm_s.allFinite());
    EXPECT_TRUE(object.motion.acceleration_mm_s2.allFinite());
    EXPECT_GE(object.motion.quality, 0.0);
    EXPECT_LE(object.motion.quality, 1.0);
  }
}

TEST(BadInput, NoDepthInsideTheMask) {
  const BallScene scene;
  const auto results = runAll(scene.info(), {}, 12, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 120 + 2.0 * double(i), 120);
    frame.depth.setTo(0, frame.mask > 0);
    return frame;
  });
  ASSERT_EQ(results.size(), 12U);
  for (const VisionResult& result : results) {
    expectSound(result);
    EXPECT_TRUE(result.frame.objects.empty()) << "nothing is known of a surface";
  }
}

TEST(BadInput, DepthThatFailsForAWhileIsTheLastOneSeen) {
  const BallScene scene;
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  const auto results = runAll(scene.info(), settings, 16, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 120, 120);
    if (i >= 5 && i < 8) frame.depth.setTo(0);
    return frame;
  });
  for (std::size_t i = 0; i < results.size(); ++i) {
    expectSound(results[i]);
    ASSERT_EQ(results[i].frame.objects.size(), 1U) << i;
    const HapticObject& object = results[i].frame.objects[0];
    EXPECT_EQ(object.relief->height_mm, results[0].frame.objects[0].relief->height_mm) << i;
    EXPECT_TRUE(object.impacts.empty());
    if (i >= 5 && i < 8) {
      EXPECT_LT(object.motion.quality, 0.9);
    }
  }
}

TEST(BadInput, AnObjectOfOnePixelIsNone) {
  const BallScene scene;
  const auto results = runAll(scene.info(), {}, 6, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 120, 120);
    frame.mask.setTo(0);
    frame.mask.at<uchar>(100, 100) = 1;
    return frame;
  });
  for (const VisionResult& result : results) EXPECT_TRUE(result.frame.objects.empty());
  // The stages themselves take it.
  cv::Mat mask = cv::Mat::zeros(240, 320, CV_8UC1);
  mask.at<uchar>(0, 319) = 255;
  const cv::Mat depth(240, 320, CV_32FC1, cv::Scalar(750));
  const Surface surface = cleanSurface(depth, mask, {{1.0}, 0.0}, Method::kHapticast);
  Workspace workspace;
  workspace.width_px = 320;
  workspace.height_px = 240;
  const auto relief = makeRelief(surface, {600, 900}, workspace, Method::kHapticast);
  ASSERT_EQ(relief->height_mm.size(), 1U);
  EXPECT_NEAR(relief->height_mm[0], 15.0F, 1e-3F);
}

TEST(BadInput, AnObjectThatFillsThePicture) {
  const BallScene scene{.radius_px = 250};
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  const auto results = runAll(scene.info(), settings, 8, [&](std::uint64_t i) {
    return scene.frame(i, 160 + double(i), 120);
  });
  for (const VisionResult& result : results) {
    expectSound(result);
    ASSERT_EQ(result.frame.objects.size(), 1U);
    EXPECT_EQ(result.frame.objects[0].relief->rect, (PixelRect{0, 0, 320, 240}));
  }
}

TEST(BadInput, UnusableNumbersInTheDepth) {
  const BallScene scene;
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(),
                       std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity(), -700.0F, 3e38F};
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  const auto results = runAll(scene.info(), settings, 8, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 120 + double(i), 120);
    for (int k = 0; k < 400; ++k) {
      const int u = 85 + (k * 37) % 70;
      const int v = 85 + (k * 53) % 70;
      frame.depth.at<float>(v, u) = bad[k % 5];
    }
    return frame;
  });
  const auto clean = runAll(scene.info(), settings, 8,
                            [&](std::uint64_t i) { return scene.frame(i, 120 + double(i), 120); });
  for (std::size_t i = 0; i < results.size(); ++i) {
    expectSound(results[i]);
    ASSERT_EQ(results[i].frame.objects.size(), 1U);
    const Relief& relief = *results[i].frame.objects[0].relief;
    const Relief& truth = *clean[i].frame.objects[0].relief;
    ASSERT_EQ(relief.mask, truth.mask);
    double square = 0;
    for (std::size_t k = 0; k < relief.mask.size(); ++k)
      square += std::pow(double(relief.height_mm[k] - truth.height_mm[k]), 2);
    EXPECT_LT(std::sqrt(square / double(relief.mask.size())), 0.15) << i;
  }
}

TEST(BadInput, TwoMasksThatMergeAreOneObjectAndOneThatFades) {
  const BallScene scene;
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  const auto results = runAll(scene.info(), settings, 20, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 120, 120);
    const RgbdFrame other = scene.frame(i, 205, 120);
    other.depth.copyTo(frame.depth, other.mask);
    other.color.copyTo(frame.color, other.mask);
    frame.mask.setTo(i < 8 ? 2 : 1, other.mask);
    return frame;
  });
  const std::uint32_t kept = results[0].frame.objects.at(0).id;
  const std::uint32_t gone = results[0].frame.objects.at(1).id;
  for (std::size_t i = 0; i < results.size(); ++i) {
    expectSound(results[i]);
    EXPECT_EQ(results[i].frame.objects.size(), i < 13 ? 2U : 1U) << i;
    EXPECT_EQ(results[i].frame.objects.at(0).id, kept);
    EXPECT_TRUE(results[i].frame.objects[0].impacts.empty()) << i;
    if (i >= 8 && i < 13) {
      EXPECT_EQ(results[i].frame.objects[1].id, gone);
      EXPECT_LT(results[i].frame.objects[1].motion.quality, 0.9);
    }
  }
}

TEST(BadInput, ARepeatedFrameIsNoMotionAndNoImpact) {
  const BallScene scene;
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  const auto results = runAll(scene.info(), settings, 20, [&](std::uint64_t i) {
    return scene.frame(i, 100 + 2.0 * double(i == 10 ? 9 : i), 120);
  });
  for (std::size_t i = 0; i < results.size(); ++i) {
    expectSound(results[i]);
    const HapticObject& object = results[i].frame.objects.at(0);
    EXPECT_TRUE(object.impacts.empty()) << i;
    EXPECT_EQ(object.id, results[0].frame.objects[0].id);
  }
  EXPECT_EQ(results[10].frame.objects[0].relief, results[9].frame.objects[0].relief);
}

// Everything is another from frame 10 on: ball, background, light.
RgbdFrame cutFrame(const BallScene& scene, std::uint64_t i, bool with_mask) {
  BallScene other = scene;
  other.radius_px = 55;
  other.background_mm = 2000;
  other.near_mm = 900;
  const bool second = i >= 10;
  RgbdFrame frame = second ? other.frame(i, 210 - 1.0 * double(i), 130)
                           : scene.frame(i, 70 + 1.0 * double(i), 100);
  if (second) cv::flip(frame.color, frame.color, 1);
  if (second) cv::flip(frame.depth, frame.depth, 1);
  if (second && with_mask) cv::flip(frame.mask, frame.mask, 1);
  // Pictures are brighter here than there, elsewhere in each scene.
  for (int u = 0; u < frame.color.cols; ++u)
    frame.color.col(u) *= 0.3 + 0.7 * std::abs((second ? 0 : 320) - u) / 320.0;
  return frame;
}

TEST(BadInput, ACutStartsANewEpochWithoutAForce) {
  for (const bool with_mask : {true, false}) {
    const BallScene scene{.with_mask = with_mask};
    VisionSettings settings;
    settings.depth_range = DepthRange{600, 1200};
    const auto results = runAll(scene.info(), settings, 24,
                                [&](std::uint64_t i) { return cutFrame(scene, i, with_mask); });
    ASSERT_EQ(results.size(), 24U);
    const std::uint32_t first_id = results[0].frame.objects.at(0).id;
    for (std::size_t i = 0; i < results.size(); ++i) {
      expectSound(results[i]);
      EXPECT_EQ(results[i].frame.epoch, results[0].frame.epoch + (i < 10 ? 0U : 1U)) << i;
      for (const HapticObject& object : results[i].frame.objects) {
        EXPECT_TRUE(object.impacts.empty()) << i;
        EXPECT_EQ(object.id == first_id, i < 10) << i;
        EXPECT_LT(object.motion.velocity_mm_s.norm(), 60) << i;  // 1 px a frame is 12.5 mm/s
      }
    }
    EXPECT_FALSE(results[23].frame.objects.empty()) << "and the new scene is found";
  }
}

TEST(BadInput, MotionPanAndBrightnessAreNoCut) {
  const BallScene scene;
  const auto results = runAll(scene.info(), {}, 20, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 40 + 12.0 * double(i), 120);
    if (i >= 6) frame.color *= 0.5;  // a lamp goes out
    if (i >= 12) {                   // the camera turns, 40 px a frame
      const cv::Matx23d turn(1, 0, -40.0 * double(i - 11), 0, 1, 0);
      for (cv::Mat* image : {&frame.color, &frame.depth, &frame.mask})
        cv::warpAffine(*image, *image, turn, image->size(), cv::INTER_NEAREST, cv::BORDER_REFLECT);
    }
    return frame;
  });
  for (const VisionResult& result : results) EXPECT_EQ(result.frame.epoch, results[0].frame.epoch);
}

TEST(BadInput, ReportsAnObjectWithoutDepthInOneLine) {
  const BallScene scene{.with_mask = false};
  VisionSettings settings;
  settings.object_points = {{{120, 120}}};
  Vision vision(scene.info(), settings);
  RgbdFrame frame = scene.frame(0, 120, 120);
  cv::rectangle(frame.depth, cv::Rect(60, 60, 120, 120), 0, cv::FILLED);  // a black monitor
  try {
    (void)vision.push(frame, mediaTime(0));
    FAIL();
  } catch (const SourceError& error) {
    const std::string line = error.what();
    EXPECT_NE(line.find("--object 120,120"), std::string::npos) << line;
    EXPECT_NE(line.find("no depth"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

TEST(BadInput, ReportsAChosenMaskWithoutDepth) {
  const BallScene scene;
  VisionSettings settings;
  settings.object_points = {{{120, 120}}};
  Vision vision(scene.info(), settings);
  RgbdFrame frame = scene.frame(0, 120, 120);
  frame.depth.setTo(0, frame.mask > 0);
  try {
    (void)vision.push(frame, mediaTime(0));
    FAIL();
  } catch (const SourceError& error) {
    EXPECT_NE(std::string(error.what()).find("no depth"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hapticast::server
