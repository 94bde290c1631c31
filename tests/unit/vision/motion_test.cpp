// SPDX-License-Identifier: MIT
#include "server/vision/motion/pose_tracker.hpp"

#include <gtest/gtest.h>

#include <random>

#include "server/vision/motion/savitzky_golay.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

cv::Mat texture(double shift_u, double shift_v) {
  cv::Mat out(200, 240, CV_8UC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      out.at<uchar>(v, u) = cv::saturate_cast<uchar>(
          30 + 200 * test::paint(0.8 * (u - shift_u), 0.8 * (v - shift_v)));
    }
  }
  return out;
}

TEST(Motion, LucasKanadeMeasuresASubPixelShift) {
  cv::Mat mask = cv::Mat::zeros(200, 240, CV_8UC1);
  cv::circle(mask, {120, 100}, 50, 255, cv::FILLED);
  for (const cv::Vec2d& shift :
       {cv::Vec2d(0.37, -0.62), cv::Vec2d(7.3, 4.8), cv::Vec2d(-0.1, 0.0)}) {
    const ObjectFlow flow = trackObject(texture(0, 0), texture(shift[0], shift[1]), mask, {0, 0});
    ASSERT_TRUE(flow.reliable);
    const cv::Point2d moved = flow.warp({120, 100}) - cv::Point2d(120, 100);
    EXPECT_NEAR(moved.x, shift[0], 0.05);
    EXPECT_NEAR(moved.y, shift[1], 0.05);
    EXPECT_NEAR(flow.rotation_rad(), 0, 0.002);
  }
}

TEST(Motion, TheTracksOfAnObjectAreThoseThatAgreeWithItsMotion) {
  cv::Mat mask = cv::Mat::zeros(200, 240, CV_8UC1);
  cv::circle(mask, {120, 100}, 50, 255, cv::FILLED);
  cv::Mat next = texture(4, 3);
  const cv::Rect other(90, 80, 30, 30);
  texture(-5, -2)(other).copyTo(next(other));
  const ObjectFlow flow = trackObject(texture(0, 0), next, mask, {0, 0});
  ASSERT_TRUE(flow.reliable);
  EXPECT_GT(flow.tracks.from.size(), 20U);
  for (std::size_t i = 0; i < flow.tracks.from.size(); ++i) {
    const cv::Point2d off = flow.warp(flow.tracks.from[i]) - cv::Point2d(flow.tracks.to[i]);
    EXPECT_LT(cv::norm(off), 2.5) << i;
  }
}

TEST(Motion, LucasKanadeFindsABounceAgainstItsGuess) {
  cv::Mat mask = cv::Mat::zeros(200, 240, CV_8UC1);
  cv::circle(mask, {120, 100}, 50, 255, cv::FILLED);
  const ObjectFlow flow = trackObject(texture(0, 0), texture(0, -6), mask, {0, 60});
  ASSERT_TRUE(flow.reliable);
  EXPECT_NEAR(flow.warp({120, 100}).y, 94, 0.1);
}

TEST(Motion, WithoutTextureTheGuessIsKeptAndNotTrusted) {
  cv::Mat mask = cv::Mat::zeros(200, 240, CV_8UC1);
  cv::circle(mask, {120, 100}, 50, 255, cv::FILLED);
  const cv::Mat plain(200, 240, CV_8UC1, cv::Scalar(90));
  const ObjectFlow flow = trackObject(plain, plain, mask, {3, 1});
  EXPECT_FALSE(flow.reliable);
  EXPECT_EQ(flow.warp({0, 0}), cv::Point2d(3, 1));
}

Surface flatSurface(int u, double depth_mm, double slope = 0) {
  Surface out;
  out.box = {u, 40, 60, 60};
  out.mask = cv::Mat(60, 60, CV_8UC1, cv::Scalar(255));
  out.measured = out.mask.clone();
  out.depth.create(60, 60, CV_32FC1);
  for (int v = 0; v < 60; ++v) {
    for (int i = 0; i < 60; ++i)
      out.depth.at<float>(v, i) = static_cast<float>(depth_mm + slope * i);
  }
  return out;
}

TEST(Motion, DepthDifferencesFollowTheMovedSurface) {
  // The slope moves along with the object: without compensation 5 px of it would read as 10 mm.
  const auto step =
      depthDifference_mm(flatSurface(40, 700, 2), flatSurface(45, 690, 2), {1, 0, 5, 0, 1, 0}, 3);
  ASSERT_TRUE(step.has_value());
  EXPECT_NEAR(*step, -10, 1e-3);
  EXPECT_FALSE(
      depthDifference_mm(flatSurface(40, 700), flatSurface(240, 700), {1, 0, 0, 0, 1, 0}, 3)
          .has_value());
}

TEST(Motion, DepthDifferencesAreNotRuinedByAFewWildPixels) {
  Surface now = flatSurface(40, 696);
  now.depth(cv::Rect(10, 10, 12, 12)).setTo(1500);
  EXPECT_NEAR(*depthDifference_mm(flatSurface(40, 700), now, {1, 0, 0, 0, 1, 0}, 3), -4, 1e-3);
}

const cv::Mat kNoGray;

PoseSettings withoutAlignment(MotionMode mode) {
  return {mode, false, false, {300, 300, 160, 120}, {320, 240}};
}

TEST(Motion, PixelsWithoutDepthDoNotCountInTheDepthOfAnObject) {
  Surface surface = flatSurface(40, 700);
  const cv::Size size = surface.box.size();
  surface.depth(cv::Rect(size.width / 2 - 3, size.height / 2 - 3, 6, 6)).setTo(0);
  const PoseTracker tracker(withoutAlignment(MotionMode::kAuto), kNoGray, surface);
  EXPECT_NEAR(tracker.pose().depth_mm, 700.0, 1e-3);
}

TEST(Motion, ARepeatedDepthFrameIsNoObservation) {
  ObjectFlow flow;
  flow.reliable = true;
  flow.similarity = {1, 0, 4, 0, 1, 0};
  PoseTracker tracker(withoutAlignment(MotionMode::kAuto), kNoGray, flatSurface(40, 700));
  const ObjectPose repeat = tracker.advance({flow, kNoGray, flatSurface(44, 700), true});
  EXPECT_FALSE(repeat.depth_seen);
  EXPECT_NEAR(repeat.u_px, 74, 1e-6);
  const ObjectPose fresh = tracker.advance({flow, kNoGray, flatSurface(48, 690)});
  EXPECT_TRUE(fresh.depth_seen);
  EXPECT_NEAR(fresh.depth_mm, 690, 1e-3);
}

TEST(Motion, AnObjectAtRestKeepsItsPoseAndCatchesUpLater) {
  ObjectFlow flow;
  flow.reliable = true;
  flow.similarity = {1, 0, 0.4, 0, 1, 0.2};  // noise, or a creep
  PoseSettings settings = withoutAlignment(MotionMode::kAuto);
  settings.exact_masks = true;
  PoseTracker tracker(settings, kNoGray, flatSurface(40, 700));
  const ObjectPose before = tracker.pose();
  for (int i = 0; i < 5; ++i) {
    const ObjectPose rest = tracker.advance({flow, kNoGray, flatSurface(41, 698), false, true});
    EXPECT_EQ(rest.u_px, before.u_px);
    EXPECT_EQ(rest.v_px, before.v_px);
    EXPECT_EQ(rest.depth_mm, before.depth_mm);
    EXPECT_EQ(rest.angle_rad, before.angle_rad);
  }
  const ObjectPose moved = tracker.advance({flow, kNoGray, flatSurface(43, 695)});
  EXPECT_NEAR(moved.u_px, before.u_px + 3, 1e-6);
  EXPECT_NEAR(moved.depth_mm, 695, 1e-3);
}

TEST(Motion, ModesLeaveOutUnmeasuredAxes) {
  ObjectFlow flow;
  flow.reliable = true;
  flow.similarity = {1, 0, 4, 0, 1, 0};
  const Surface later = flatSurface(44, 690);
  const auto moved = [&](MotionMode mode) {
    PoseTracker tracker(withoutAlignment(mode), kNoGray, flatSurface(40, 700));
    const ObjectPose before = tracker.pose();
    const ObjectPose now = tracker.advance({flow, kNoGray, later});
    return std::pair{now.u_px - before.u_px, now.depth_mm - before.depth_mm};
  };
  EXPECT_EQ(moved(MotionMode::kNone), (std::pair{0.0, 0.0}));
  EXPECT_EQ(moved(MotionMode::kLk).second, 0.0);
  EXPECT_NEAR(moved(MotionMode::kLk).first, 4, 1e-6);
  EXPECT_EQ(moved(MotionMode::kDepth).first, 0.0);
  EXPECT_LT(moved(MotionMode::kDepth).second, -9);
  EXPECT_NEAR(moved(MotionMode::kAuto).first, 4, 1e-6);
  EXPECT_LT(moved(MotionMode::kAuto).second, -9);
}

std::vector<Sample> collectSamples(double fps, int count,
                                   const std::function<Vec3(double)>& position) {
  std::vector<Sample> out;
  out.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) out.push_back({i / fps, position(i / fps), 0.5 * i / fps, true});
  return out;
}

TEST(Motion, LookaheadIsConstantInTime) {
  EXPECT_EQ(lookaheadFrames(24), 3);
  EXPECT_EQ(lookaheadFrames(25), 3);
  EXPECT_EQ(lookaheadFrames(30), 3);
  EXPECT_EQ(lookaheadFrames(60), 5);
  EXPECT_EQ(lookaheadFrames(1), 3);
}

TEST(Motion, WindowGivesVelocityAndAcceleration) {
  const auto path = [](double t) {
    return Vec3(20 * std::sin(6 * t), 15 * std::cos(5 * t), 8 * std::sin(4 * t + 1));
  };
  const std::vector<Sample> samples = collectSamples(25, 20, path);
  for (std::size_t at = 3; at + 3 < samples.size(); ++at) {
    const double t = samples[at].time_s;
    const Motion motion = computeMotion({samples.begin() + static_cast<std::ptrdiff_t>(at) - 3,
                                         samples.begin() + static_cast<std::ptrdiff_t>(at) + 4},
                                        3, 3);
    const Vec3 velocity(120 * std::cos(6 * t), -75 * std::sin(5 * t), 32 * std::cos(4 * t + 1));
    const Vec3 acceleration(-720 * std::sin(6 * t), -375 * std::cos(5 * t),
                            -128 * std::sin(4 * t + 1));
    EXPECT_LT((motion.position_mm - path(t)).norm(), 0.01);
    EXPECT_LT((motion.velocity_mm_s - velocity).norm(), 0.5);
    EXPECT_LT((motion.acceleration_mm_s2 - acceleration).norm(), 15);
    EXPECT_NEAR(motion.angular_velocity_rad_s, 0.5, 1e-9);
  }
}

TEST(Motion, WindowOfAParabolaIsExactAtTheEndsToo) {
  const std::vector<Sample> samples = collectSamples(
      25, 5, [](double t) { return Vec3(3 + 40 * t + 200 * t * t, -100 * t * t, 5); });
  for (std::size_t at = 0; at < samples.size(); ++at) {
    const Motion motion = computeMotion(samples, at, 3);
    EXPECT_NEAR(motion.acceleration_mm_s2.x(), 400, 1e-6);
    EXPECT_NEAR(motion.acceleration_mm_s2.y(), -200, 1e-6);
    EXPECT_NEAR(motion.velocity_mm_s.x(), 40 + 400 * samples[at].time_s, 1e-6);
    EXPECT_EQ(motion.acceleration_mm_s2.z(), 0);
  }
}

TEST(Motion, AStillObjectHasNoMotion) {
  const std::vector<Sample> samples =
      collectSamples(25, 7, [](double) { return Vec3(12.3456, -7.891, 14.2); });
  const Motion motion = computeMotion(samples, 3, 3);
  EXPECT_EQ(motion.velocity_mm_s, Vec3::Zero());
  EXPECT_EQ(motion.acceleration_mm_s2, Vec3::Zero());
  EXPECT_EQ(motion.position_mm, samples[3].position_mm);
}

TEST(Motion, OneSampleIsAPlaceWithoutMotion) {
  const Motion motion =
      computeMotion(collectSamples(25, 1, [](double) { return Vec3(1, 2, 3); }), 0, 3);
  EXPECT_EQ(motion.position_mm, Vec3(1, 2, 3));
  EXPECT_EQ(motion.velocity_mm_s, Vec3::Zero());
}

TEST(Motion, ARepeatedDepthIsLeftOutOfTheWindow) {
  std::vector<Sample> samples = collectSamples(25, 7, [](double t) { return Vec3(0, 0, 100 * t); });
  samples[3].position_mm.z() = samples[2].position_mm.z();
  samples[3].depth_seen = false;
  const Motion motion = computeMotion(samples, 3, 3);
  EXPECT_NEAR(motion.velocity_mm_s.z(), 100, 1e-6);
  EXPECT_NEAR(motion.position_mm.z(), 12, 1e-6);
  EXPECT_NEAR(motion.acceleration_mm_s2.z(), 0, 1e-6);
}

TEST(Motion, ABounceIsNotSmearedIntoAcceleration) {
  // Falls with 2000 mm/s² and bounces at t = 0.3 s with 600 mm/s.
  const auto path = [](double t) {
    const double s = std::abs(t - 0.3);
    return Vec3(40 * t, 600 * s - 1000 * s * s, 0);
  };
  const std::vector<Sample> samples = collectSamples(25, 16, path);
  for (std::size_t at = 3; at + 3 < samples.size(); ++at) {
    const Motion motion = computeMotion({samples.begin() + static_cast<std::ptrdiff_t>(at) - 3,
                                         samples.begin() + static_cast<std::ptrdiff_t>(at) + 4},
                                        3, 3);
    EXPECT_NEAR(motion.acceleration_mm_s2.y(), -2000, 20) << at;
  }
}

}  // namespace
}  // namespace hapticast::server
