// SPDX-License-Identifier: MIT
// Objects that leave, are hidden, come back, and bodies that touch each other.
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/scenes/ball_scene.hpp"
#include "tests/unit/vision/segment_runner.hpp"

namespace hapticast::server {
namespace {

using test::overlap;
using test::Runner;

// An orange ball, a green one (its colours exchanged) and a grey board before both, each where it
// is wanted or nowhere.
struct Scene {
  test::BallScene ball{.radius_px = 30, .with_mask = true};
  Vec2 orange{-200, 120};
  Vec2 green{-200, 120};
  cv::Rect board;

  struct Picture {
    RgbdFrame frame;
    cv::Mat orange, green, board;  // what is seen of each
  };

  [[nodiscard]] Picture at(std::uint64_t index) const {
    Picture out;
    out.frame = ball.frame(index, orange.x(), orange.y());
    RgbdFrame other = ball.frame(index, green.x(), green.y());
    const int exchange[] = {0, 0, 1, 2, 2, 1};
    cv::mixChannels(other.color.clone(), other.color, std::vector<int>(exchange, exchange + 6));
    out.orange = out.frame.mask > 0;
    out.green = (other.mask > 0) & (out.orange == 0);
    other.color.copyTo(out.frame.color, out.green);
    other.depth.copyTo(out.frame.depth, out.green);
    out.board = cv::Mat::zeros(ball.height, ball.width, CV_8UC1);
    const cv::Rect seen = board & cv::Rect(0, 0, ball.width, ball.height);
    if (!seen.empty()) {
      out.board(seen).setTo(255);
      out.frame.depth(seen).setTo(550);
      for (int v = seen.y; v < seen.br().y; ++v) {
        for (int u = seen.x; u < seen.br().x; ++u) {
          const auto level = cv::saturate_cast<uchar>(60 + 90 * test::paint(u - board.x, v));
          out.frame.color.at<cv::Vec3b>(v, u) = {level, level, level};
        }
      }
    }
    out.orange &= ~out.board;
    out.green &= ~out.board;
    out.frame.mask = cv::Mat();
    return out;
  }
};

Runner runnerOf(const Scene& scene, std::uint32_t& next_id, const std::vector<Vec2>& points,
                const std::vector<Vec2>& not_points = {}) {
  VisionSettings settings;
  for (const Vec2& point : points) settings.object_points.push_back({point});
  for (const Vec2& point : not_points) settings.not_points.push_back({point});
  return {scene.ball.info(), makeSegmenter(settings, false, next_id), {}, {}};
}

// How much of what is called the object is not it.
double wrongShare(const cv::Mat& mask, const cv::Mat& truth) {
  return double(cv::countNonZero(mask & ~truth)) / std::max(1, cv::countNonZero(mask));
}

TEST(SegmentLost, FindsAnObjectThatComesBackIntoThePicture) {
  Scene scene;
  scene.green = {250, 70};  // is not what was lost
  std::uint32_t id = 1;
  Runner runner = runnerOf(scene, id, {{100, 140}});
  int without = 0;
  int since_back = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    // Out on the left by frame 16, away until frame 35, whole again from frame 42 on.
    scene.orange = {i < 30 ? 100.0 - 9.0 * double(i) : -280.0 + 8.0 * double(i - 5), 140.0};
    const Scene::Picture now = scene.at(i);
    runner.next(now.frame);
    if (runner.segments.empty()) ++without;
    for (const Segment& segment : runner.segments) {
      EXPECT_LT(wrongShare(segment.mask, now.orange), 0.3) << i;
      EXPECT_LE(segment.id, 2U);
      if (segment.id == 2) ++since_back;
    }
  }
  EXPECT_GT(without, 15);
  EXPECT_GT(since_back, 8);
  ASSERT_EQ(runner.segments.size(), 1U);
  EXPECT_EQ(runner.segments[0].id, 2U);
  EXPECT_GT(overlap(runner.segments[0].mask, scene.at(59).orange), 0.93);
}

TEST(SegmentLost, FindsAnObjectAfterASecondOfOcclusion) {
  Scene scene;
  scene.orange = {120, 120};
  scene.green = {260, 120};
  std::uint32_t id = 1;
  Runner runner = runnerOf(scene, id, {{120, 120}});
  int without = 0;
  for (std::uint64_t i = 0; i < 70; ++i) {
    const double hides = i < 10 ? 320 - 30.0 * double(i) : i < 38 ? 60 : 60 - 30.0 * double(i - 38);
    scene.board = {static_cast<int>(hides), 0, 120, 240};
    const Scene::Picture now = scene.at(i);
    runner.next(now.frame);
    if (runner.segments.empty()) ++without;
    for (const Segment& segment : runner.segments)
      EXPECT_LT(wrongShare(segment.mask, now.orange), 0.3) << i;
  }
  EXPECT_GE(without, 25);
  EXPECT_LT(without, 40);
  ASSERT_EQ(runner.segments.size(), 1U);
  EXPECT_EQ(runner.segments[0].id, 2U);
  EXPECT_GT(overlap(runner.segments[0].mask, scene.at(69).orange), 0.93);
}

TEST(SegmentLost, APassingOccluderHidesOnlyItsPart) {
  Scene scene;
  scene.orange = {160, 120};
  std::uint32_t id = 1;
  Runner runner = runnerOf(scene, id, {{160, 120}});
  for (std::uint64_t i = 0; i < 24; ++i) {
    scene.board = {20 + 12 * static_cast<int>(i), 0, 16, 240};
    const Scene::Picture now = scene.at(i);
    runner.next(now.frame);
    ASSERT_EQ(runner.segments.size(), 1U) << i;
    EXPECT_EQ(runner.segments[0].id, 1U);
    EXPECT_GT(overlap(runner.segments[0].mask, now.orange), 0.85) << i;
  }
}

// A board hides the ball, and the motion that was measured is the board's.
TEST(SegmentLost, AnOccluderDoesNotCarryTheMaskAway) {
  for (const double step_px : {-25.0, -40.0, 35.0}) {
    Scene scene;
    scene.orange = {160, 120};
    std::uint32_t id = 1;
    Runner runner = runnerOf(scene, id, {{160, 120}});
    for (std::uint64_t i = 0; i < 4; ++i) runner.next(scene.at(i).frame);
    scene.board = {155, 0, 90, 240};
    runner.next(scene.at(4).frame);
    ASSERT_EQ(runner.segments.size(), 1U);
    scene.board.x = 120;
    ObjectFlow of_board;
    of_board.similarity(0, 2) = step_px;
    of_board.reliable = true;
    for (std::uint64_t i = 5; i < 8; ++i) {
      const Scene::Picture now = scene.at(i);
      runner.next(now.frame, of_board);
      for (const Segment& segment : runner.segments)
        EXPECT_LT(wrongShare(segment.mask, now.orange), 0.3) << step_px << " px, frame " << i;
    }
  }
}

TEST(SegmentLost, BodiesThatMeetStayTwoObjects) {
  Scene scene;
  std::uint32_t id = 1;
  Runner runner = runnerOf(scene, id, {{60, 120}, {260, 120}});
  for (std::uint64_t i = 0; i < 50; ++i) {
    // They meet in frame 35 and go on together.
    const double step = std::min(2.0 * double(i), 70.0);
    const double together = i > 35 ? 2.0 * double(i - 35) : 0.0;
    scene.orange = {60 + step, 120 + together};
    scene.green = {260 - step, 120 + together};
    const Scene::Picture now = scene.at(i);
    runner.next(now.frame);
    ASSERT_EQ(runner.segments.size(), 2U) << i;
    EXPECT_EQ(runner.segments[0].id, 1U);
    EXPECT_EQ(runner.segments[1].id, 2U);
    EXPECT_GT(overlap(runner.segments[0].mask, now.orange), 0.93) << i;
    EXPECT_GT(overlap(runner.segments[1].mask, now.green), 0.93) << i;
    const int shared = cv::countNonZero(runner.segments[0].mask & runner.segments[1].mask);
    EXPECT_EQ(shared, 0) << i;
  }
}

TEST(SegmentLost, ExcludesAnotherObjectWhileBothMove) {
  Scene scene;
  std::uint32_t id = 1;
  Runner runner = runnerOf(scene, id, {{70, 100}}, {{128, 100}});
  for (std::uint64_t i = 0; i < 25; ++i) {
    scene.orange = {70 + 4.0 * double(i), 100 + 1.5 * double(i)};
    scene.green = scene.orange + Vec2(58, 0);
    const Scene::Picture now = scene.at(i);
    runner.next(now.frame);
    ASSERT_EQ(runner.segments.size(), 1U) << i;
    EXPECT_GT(overlap(runner.segments[0].mask, now.orange), 0.9) << i;
  }
}

}  // namespace
}  // namespace hapticast::server
