// SPDX-License-Identifier: MIT
// Vision with two threads yields the frames of one thread, bit by bit and one push() later.
#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

struct ThreadsCase {
  Method method = Method::kHapticast;
  SegmentMode segment = SegmentMode::kBand;
  bool live = true;
  bool offline = false;
};

// A ball that moves, rests, and moves again; the clip begins anew in the middle.
std::vector<RgbdFrame> makeMovement(const test::BallScene& scene) {
  std::vector<RgbdFrame> out;
  for (const std::uint32_t epoch : {0U, 1U}) {
    for (std::uint64_t i = 0; i < 24; ++i) {
      const double step = i < 8 ? double(i) : i < 16 ? 8.0 : double(i) - 8.0;
      RgbdFrame frame = scene.frame(i, 100 + 3.0 * step + (epoch == 1 ? 4.0 : 0.0), 120);
      frame.epoch = epoch;
      out.push_back(frame);
    }
  }
  return out;
}

std::vector<VisionResult> runVision(const ThreadsCase& with, int threads) {
  test::BallScene scene;
  scene.with_mask = with.segment == SegmentMode::kSource;
  SourceInfo info = scene.info();
  info.live = with.live;
  VisionSettings settings;
  settings.method = with.method;
  settings.segment = with.segment;
  settings.offline = with.offline;
  settings.threads = threads;
  settings.object_points = {{{100, 120}}};
  Vision vision(info, settings);
  std::vector<VisionResult> out;
  std::uint64_t index = 0;
  for (const RgbdFrame& frame : makeMovement(scene)) {
    if (auto result = vision.push(frame, mediaTime(double(index++) / 25)))
      out.push_back(std::move(*result));
  }
  for (VisionResult& result : vision.flush()) out.push_back(std::move(result));
  return out;
}

void expectEqualObjects(const HapticObject& a, const HapticObject& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.changed_in_frame, b.changed_in_frame);
  EXPECT_EQ(a.relief->rect, b.relief->rect);
  EXPECT_EQ(a.relief->mask, b.relief->mask);
  EXPECT_EQ(a.relief->height_mm, b.relief->height_mm);
  EXPECT_EQ(a.impacts, b.impacts);
  EXPECT_EQ(a.motion, b.motion);
  ASSERT_EQ(a.grid == nullptr, b.grid == nullptr);
  if (a.grid) {
    EXPECT_EQ(a.grid->velocity_mm_s, b.grid->velocity_mm_s);
    EXPECT_EQ(a.grid->acceleration_mm_s2, b.grid->acceleration_mm_s2);
  }
}

void expectEqualRuns(const ThreadsCase& with) {
  const std::vector<VisionResult> one = runVision(with, 1);
  const std::vector<VisionResult> two = runVision(with, 2);
  ASSERT_EQ(one.size(), 48U);
  ASSERT_EQ(two.size(), one.size());
  std::size_t objects = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(one[i].frame.id, two[i].frame.id);
    EXPECT_EQ(one[i].frame.epoch, two[i].frame.epoch);
    EXPECT_EQ(one[i].frame.media_time, two[i].frame.media_time);
    EXPECT_EQ(one[i].measured.size(), two[i].measured.size());
    ASSERT_EQ(one[i].frame.objects.size(), two[i].frame.objects.size());
    for (std::size_t k = 0; k < one[i].frame.objects.size(); ++k, ++objects)
      expectEqualObjects(one[i].frame.objects[k], two[i].frame.objects[k]);
  }
  EXPECT_GE(objects, one.size());
}

TEST(VisionThreads, TwoThreadsYieldTheFramesOfOne) {
  expectEqualRuns({});
  expectEqualRuns({.segment = SegmentMode::kSource});
  expectEqualRuns({.live = false, .offline = true});
  expectEqualRuns({.method = Method::kThesis, .segment = SegmentMode::kEdges});
}

// Each of these calls waits for the second thread, and no frame is lost.
TEST(VisionThreads, OtherCallsWaitForTheSecondThread) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.threads = 2;
  Vision vision(scene.info(), settings);
  std::size_t frames = 0;
  std::uint64_t index = 0;
  const auto push = [&](int count) {
    for (int i = 0; i < count; ++i, ++index) {
      const double u = 100 + 2.0 * double(index);
      if (vision.push(scene.frame(index, u, 120), mediaTime(double(index) / 25))) ++frames;
    }
  };
  push(5);
  settings.material.stiffness_N_mm = 0.2;
  vision.setMaterials(settings);
  EXPECT_FALSE(vision.plan().empty());
  EXPECT_EQ(vision.name(1), "");
  push(3);
  RgbdFrame wrong = scene.frame(index, 100, 120);
  wrong.depth = cv::Mat(10, 10, CV_32FC1, cv::Scalar(700));
  EXPECT_THROW((void)vision.push(wrong, mediaTime(double(index) / 25)), SourceError);
  push(2);
  frames += vision.flush().size();
  EXPECT_EQ(frames, 10U);
  vision.beginAnew();
  push(3);  // the destructor waits, too
}

TEST(VisionThreads, OneMoreFrameOfDelayIsStated) {
  const test::BallScene scene;
  VisionSettings settings;
  settings.threads = 1;
  const Vision one(scene.info(), settings);
  settings.threads = 2;
  const Vision two(scene.info(), settings);
  EXPECT_NEAR(toSeconds(two.description().pipeline_latency - one.description().pipeline_latency),
              1.0 / scene.info().fps, 1e-6);
}

TEST(VisionThreads, OnlyLargePicturesUseTwoThreadsUnasked) {
  const test::BallScene scene;
  const auto latencyOf = [&](int width, int height, bool low_latency) {
    SourceInfo info = scene.info();
    info.width_px = width;
    info.height_px = height;
    VisionSettings settings;
    settings.low_latency = low_latency;
    const double frames = toSeconds(Vision(info, settings).description().pipeline_latency);
    settings.threads = 1;
    return frames - toSeconds(Vision(info, settings).description().pipeline_latency);
  };
  EXPECT_EQ(latencyOf(640, 480, false), 0.0);
  EXPECT_EQ(latencyOf(1280, 720, true), 0.0);
  if (std::thread::hardware_concurrency() > 1) {
    EXPECT_GT(latencyOf(1280, 720, false), 0.0);
  }
}

}  // namespace
}  // namespace hapticast::server
