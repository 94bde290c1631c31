// SPDX-License-Identifier: MIT
#include "server/vision/vision.hpp"

#include <gtest/gtest.h>

#include "server/source/synthetic/synthetic_scene.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

using test::BallScene;
using test::FunctionSource;

std::vector<VisionResult> runAll(Vision& vision, RgbdSource& source) {
  std::vector<VisionResult> out;
  double time_s = 10.0;
  while (auto frame = source.read()) {
    if (auto result = vision.push(*frame, mediaTime(time_s))) out.push_back(*result);
    time_s += 1 / source.info().fps;
  }
  for (VisionResult& result : vision.flush()) out.push_back(result);
  return out;
}

double middle(const Relief& relief) {
  const int index = relief.rect.height / 2 * relief.rect.width + relief.rect.width / 2;
  return double(relief.height_mm[static_cast<std::size_t>(index)]);
}

TEST(Vision, EveryFrameComesOutOnceInOrderAfterTheLookahead) {
  const BallScene scene;
  Vision vision(scene.info(), {});
  EXPECT_EQ(vision.description().pipeline_latency, fromSeconds(3 / 25.0));
  std::uint64_t out = 0;
  for (std::uint64_t i = 0; i < 8; ++i) {
    const auto result =
        vision.push(scene.frame(i, 100 + 3.0 * double(i), 120), mediaTime(double(i) / 25));
    EXPECT_EQ(result.has_value(), i >= 3);
    if (result) {
      EXPECT_EQ(result->frame.media_time, mediaTime(double(out++) / 25));
    }
  }
  EXPECT_EQ(vision.flush().size(), 3U);
  EXPECT_TRUE(vision.flush().empty());
}

TEST(Vision, MotionOfABallInThePlane) {
  const BallScene scene;
  const auto u = [](double t) { return 160 + 60 * std::sin(5 * t); };
  const auto v = [](double t) { return 120 + 40 * std::cos(4 * t); };
  FunctionSource source(scene.info(), 40, [&](std::uint64_t i) {
    const double t = double(i) / 25;
    return scene.frame(i, u(t), v(t));
  });
  Vision vision(source.info(), {});
  vision.scan(source, {});
  const std::vector<VisionResult> results = runAll(vision, source);
  ASSERT_EQ(results.size(), 40U);
  double square_error = 0;
  double square = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    ASSERT_EQ(results[i].frame.objects.size(), 1U);
    const Motion& motion = results[i].frame.objects[0].motion;
    const double t = double(i) / 25;
    EXPECT_NEAR(motion.position_mm.x(), (u(t) - 160) * 0.5, 0.1);
    EXPECT_NEAR(motion.position_mm.y(), (120 - v(t)) * 0.5, 0.1);
    if (i < 3 || i + 3 >= results.size()) continue;
    EXPECT_NEAR(motion.velocity_mm_s.x(), 0.5 * 300 * std::cos(5 * t), 2.5);
    const Vec3 acceleration(-0.5 * 1500 * std::sin(5 * t), 0.5 * 640 * std::cos(4 * t), 0);
    square_error += (motion.acceleration_mm_s2 - acceleration).squaredNorm();
    square += acceleration.squaredNorm();
  }
  EXPECT_LT(std::sqrt(square_error / square), 0.04);
  EXPECT_NEAR(vision.description().largest_acceleration_mm_s2, 800, 150);
}

TEST(Vision, ABallThatComesNearerRises) {
  const BallScene scene;
  FunctionSource source(scene.info(), 16,
                        [&](std::uint64_t i) { return scene.frame(i, 160, 120, 4.0 * double(i)); });
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 900};
  Vision vision(source.info(), settings);
  for (const VisionResult& result : runAll(vision, source)) {
    EXPECT_NEAR(result.frame.objects.at(0).motion.velocity_mm_s.z(), 0.4 * 25, 0.1);
    EXPECT_NEAR(result.frame.objects.at(0).motion.velocity_mm_s.x(), 0, 0.1);
  }
}

TEST(Vision, AStillSceneHasNoMotionAndOneRelief) {
  for (const bool with_mask : {true, false}) {
    const BallScene scene{.with_mask = with_mask};
    FunctionSource source(scene.info(), 10,
                          [&](std::uint64_t i) { return scene.frame(i, 160, 120); });
    VisionSettings settings;
    settings.object_points = {{{160, 120}}};
    Vision vision(source.info(), settings);
    const std::vector<VisionResult> results = runAll(vision, source);
    for (const VisionResult& result : results) {
      const HapticObject& object = result.frame.objects.at(0);
      EXPECT_EQ(object.motion.velocity_mm_s, Vec3::Zero());
      EXPECT_EQ(object.motion.acceleration_mm_s2, Vec3::Zero());
      EXPECT_EQ(object.motion.angular_velocity_rad_s, 0.0);
      EXPECT_EQ(object.relief, results[0].frame.objects[0].relief);
      EXPECT_EQ(object.changed_in_frame, results[0].frame.id);
    }
  }
}

TEST(Vision, EightBitHeightsMapToThirtyMillimetres) {
  BallScene scene{.near_mm = 620, .kind = DepthKind::kHeight};
  VisionSettings settings;
  settings.map_range = kHeightRange;
  Vision vision(scene.info(), settings);
  (void)vision.push(scene.frame(0, 160, 120), mediaTime(0));
  const auto results = vision.flush();
  const Relief& relief = *results.at(0).frame.objects.at(0).relief;
  EXPECT_NEAR(middle(relief), std::round(255 * 380 / 400.0) * 30 / 255, 0.1);
}

TEST(Vision, ANewSourceEpochIsANewStreamEpochWithoutMemory) {
  const BallScene scene;
  Vision vision(scene.info(), {});
  std::vector<VisionResult> results;
  for (std::uint64_t i = 0; i < 12; ++i) {
    RgbdFrame frame = scene.frame(i % 6, i < 6 ? 60 + 10.0 * double(i) : 200, 120);
    frame.epoch = i < 6 ? 4 : 5;
    if (auto result = vision.push(frame, mediaTime(double(i) / 25))) results.push_back(*result);
  }
  for (VisionResult& result : vision.flush()) results.push_back(result);
  ASSERT_EQ(results.size(), 12U);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(results[i].frame.id, results[0].frame.id + i);
    EXPECT_EQ(results[i].frame.epoch, results[0].frame.epoch + (i < 6 ? 0 : 1));
    EXPECT_NEAR(results[i].frame.objects.at(0).motion.velocity_mm_s.x(), i < 6 ? 125 : 0, 1.0);
  }
  EXPECT_NE(results[5].frame.objects[0].id, results[6].frame.objects[0].id);
}

TEST(Vision, ALostObjectFadesAndIsDropped) {
  const BallScene scene;
  FunctionSource source(scene.info(), 20, [&](std::uint64_t i) {
    return i < 8 || i >= 16 ? scene.frame(i, 100, 120) : scene.frame(i, -300, 120);
  });
  Vision vision(source.info(), {});
  const std::vector<VisionResult> results = runAll(vision, source);
  ASSERT_EQ(results.size(), 20U);
  double quality = 1.0;
  for (std::size_t i = 8; i < 13; ++i) {
    const HapticObject& object = results[i].frame.objects.at(0);
    EXPECT_EQ(object.id, results[0].frame.objects[0].id);
    EXPECT_LT(object.motion.quality, quality);
    quality = object.motion.quality;
    EXPECT_EQ(object.relief, results[7].frame.objects[0].relief);
    EXPECT_EQ(object.motion.velocity_mm_s, Vec3::Zero());
  }
  EXPECT_TRUE(results[13].frame.objects.empty());
  EXPECT_GT(results[16].frame.objects.at(0).id, results[0].frame.objects[0].id);
}

TEST(Vision, AnObjectLeavingThePictureGetsLessVisible) {
  const BallScene scene;
  FunctionSource source(scene.info(), 12,
                        [&](std::uint64_t i) { return scene.frame(i, 60 - 8.0 * double(i), 120); });
  Vision vision(source.info(), {});
  const std::vector<VisionResult> results = runAll(vision, source);
  EXPECT_GT(results[1].frame.objects.at(0).motion.visible_fraction, 0.98);
  EXPECT_LT(results[9].frame.objects.at(0).motion.visible_fraction, 0.45);
  EXPECT_GT(results[9].frame.objects[0].motion.quality, 0.0);
  for (const VisionResult& result : results) {
    if (result.frame.objects.empty()) continue;
    const Motion& motion = result.frame.objects[0].motion;
    if (motion.visible_fraction < 0.25) {
      EXPECT_EQ(motion.quality, 0.0);
    }
  }
  // The body goes on moving although its visible part hardly does.
  EXPECT_NEAR(results[6].frame.objects.at(0).motion.velocity_mm_s.x(), -8 * 0.5 * 25, 8);
}

TEST(Vision, PointsOutsideThePictureAreRefused) {
  const BallScene scene;
  for (const Vec2& point : {Vec2(320, 10), Vec2(-1, 10), Vec2(5, 240), Vec2(std::nan(""), 3)}) {
    VisionSettings settings;
    settings.object_points = {{point}};
    try {
      Vision vision(scene.info(), settings);
      FAIL();
    } catch (const SourceError& error) {
      EXPECT_NE(std::string(error.what()).find("320x240"), std::string::npos);
    }
  }
}

TEST(Vision, AScanEndsAtItsLimit) {
  const BallScene scene;
  FunctionSource source(scene.info(), 10,
                        [&](std::uint64_t i) { return scene.frame(i, 160, 120, 0); });
  Vision vision(source.info(), {});
  std::uint64_t last_done = 0;
  EXPECT_FALSE(vision.scan(source, [&](std::uint64_t done, std::uint64_t) {
    last_done = done;
    return done < 3;
  }));
  EXPECT_EQ(last_done, 3U);
  EXPECT_EQ(vision.description().largest_acceleration_mm_s2, 0.0);
}

TEST(Vision, ScanFindsOneRangeForTheClipAndRewinds) {
  const BallScene scene;
  FunctionSource source(scene.info(), 10, [&](std::uint64_t i) {
    return scene.frame(i, 160, 120, 10.0 * double(i));
  });
  Vision vision(source.info(), {});
  std::uint64_t last_done = 0;
  const bool all = vision.scan(source, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(done, ++last_done);
    EXPECT_EQ(total, 10U);
    return true;
  });
  EXPECT_TRUE(all);
  EXPECT_EQ(last_done, 10U);
  const std::vector<VisionResult> results = runAll(vision, source);
  ASSERT_EQ(results.size(), 10U);
  const auto top = [](const VisionResult& result) {
    return middle(*result.frame.objects.at(0).relief);
  };
  EXPECT_LT(top(results[9]), 30.0);
  EXPECT_GT(top(results[9]), 26.0);
  EXPECT_NEAR(top(results[9]) - top(results[0]), 18.8, 1.5);  // 90 mm of some 145
}

TEST(Vision, TheThesisMethodSendsADenseGrid) {
  const BallScene scene;
  FunctionSource source(scene.info(), 12, [&](std::uint64_t i) {
    return scene.frame(i, 100 + 3.0 * double(i), 120);
  });
  VisionSettings settings;
  settings.method = Method::kThesis;
  Vision vision(source.info(), settings);
  const std::vector<VisionResult> results = runAll(vision, source);
  const HapticObject& object = results[6].frame.objects.at(0);
  ASSERT_NE(object.grid, nullptr);
  EXPECT_EQ(object.grid->columns, 6);
  EXPECT_EQ(object.grid->rows, 5);
  ASSERT_EQ(object.grid->velocity_mm_s.size(), 30U);
  // What it adds to the object's own motion is the flow's. The visible front is nearer than the
  // centre and moves faster in the picture.
  EXPECT_NEAR(object.motion.velocity_mm_s.x() + double(object.grid->velocity_mm_s[15].x()),
              3 * 0.5 * 25 * 780 / 705, 1.0);
  EXPECT_NEAR(object.motion.velocity_mm_s.x(), 3 * 0.5 * 25, 6.0);
  EXPECT_NEAR(
      object.motion.acceleration_mm_s2.x() + double(object.grid->acceleration_mm_s2[15].x()), 0,
      20);
}

TEST(Vision, TheBouncesOfASceneAreAnnounced) {
  const auto source = openSource("synthetic:bounce", 25);
  Vision vision(source->info(), {});
  const SyntheticScene scene(SceneKind::kBounce, vision.description().workspace);
  vision.scan(*source, {});
  std::vector<Impact> found;
  const std::uint64_t count = source->info().frame_count.value();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto result = vision.push(*source->read(), mediaTime(double(i) / 25));
    if (!result || result->frame.objects.empty()) continue;
    for (const Impact& impact : result->frame.objects[0].impacts) {
      if (found.empty() || impact.time > found.back().time) found.push_back(impact);
    }
  }
  std::size_t next = 0;
  double worst_ms = 0;
  double worst_share = 0;
  for (const SceneImpact& truth : scene.impacts()) {
    if (truth.time_s < 0.12 || truth.time_s > double(count) / 25 - 0.32) continue;
    ASSERT_LT(next, found.size()) << truth.time_s;
    const Vec3 off = found[next].delta_velocity_mm_s - truth.delta_velocity_mm_s;
    worst_ms = std::max(worst_ms, 1e3 * std::abs(toSeconds(found[next].time) - truth.time_s));
    worst_share = std::max(worst_share, off.norm() / truth.delta_velocity_mm_s.norm());
    ++next;
  }
  EXPECT_EQ(next, found.size());
  EXPECT_GT(next, 2U);
  EXPECT_LT(worst_ms, 2.0);
  EXPECT_LT(worst_share, 0.1);
}

// A grid's window back across a bounce would contain a false deformation: 0.4 m/s² of a
// rigid ball.
TEST(Vision, NoGridAfterABounce) {
  const auto source = openSource("synthetic:bounce", 25);
  VisionSettings settings;
  settings.plan.forced[std::size_t(Stage::kGrid)] = true;
  Vision vision(source->info(), settings);
  const SyntheticScene scene(SceneKind::kBounce, vision.description().workspace);
  std::size_t grids = 0;
  for (const VisionResult& result : runAll(vision, *source)) {
    const double time_s = toSeconds(result.frame.media_time) - 10.0;  // as runAll() counts
    if (result.frame.objects.at(0).grid == nullptr) continue;
    ++grids;
    for (const SceneImpact& impact : scene.impacts()) {
      const double frames = 25.0 * (time_s - impact.time_s);
      EXPECT_TRUE(frames < 0.0 || frames > 3.9 || impact.time_s < 0.3) << time_s;
    }
  }
  EXPECT_GT(grids, 20U);
}

// Three values in the whole picture say nothing of the step of 8-bit depth.
TEST(Vision, AFlatStepIn8BitDepthMakesTwoLayers) {
  SourceInfo info;
  info.name = "step";
  info.width_px = 320;
  info.height_px = 240;
  info.depth_kind = DepthKind::kHeight;
  info.depth_range = {1000, 1120};
  Vision vision(info, {});
  RgbdFrame frame;
  frame.color = cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(0));
  frame.mask = cv::Mat::zeros(240, 320, CV_8UC1);
  frame.mask(cv::Rect(80, 60, 160, 120)).setTo(1);
  frame.depth(cv::Rect(80, 60, 80, 120)).setTo(148);
  frame.depth(cv::Rect(160, 60, 80, 120)).setTo(63);
  (void)vision.push(frame, mediaTime(0));
  const std::vector<VisionResult> results = vision.flush();
  ASSERT_EQ(results.size(), 1U);
  ASSERT_EQ(results[0].frame.objects.size(), 2U);
  EXPECT_EQ(results[0].frame.objects[0].relief->rect, (PixelRect{80, 60, 80, 120}));
  EXPECT_EQ(results[0].frame.objects[1].relief->rect, (PixelRect{160, 60, 80, 120}));
}

}  // namespace
}  // namespace hapticast::server
