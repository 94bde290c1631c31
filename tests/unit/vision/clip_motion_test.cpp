// SPDX-License-Identifier: MIT
#include "server/vision/motion/clip_smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/vision/frame_motion.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

constexpr double kFps = 60.0;
constexpr int kLookahead = 5;

struct Track {
  std::vector<Sample> samples;
  std::vector<Vec3> truth_mm_s2;
};

// Swings of 0.9 and 1.6 Hz, measured to a fiftieth of a millimetre.
Track swinging(double noise_mm) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, noise_mm);
  Track out;
  const double w = 2 * CV_PI * 0.9;
  const double q = 2 * CV_PI * 1.6;
  for (int i = 0; i < 240; ++i) {
    const double t = i / kFps;
    Sample sample;
    sample.time_s = t;
    sample.position_mm = {20 * std::sin(w * t) + noise(random), 9 * std::cos(q * t) + noise(random),
                          15 + 4 * std::sin(q * t) + noise(random)};
    sample.angle_rad = 0.3 * std::sin(w * t);
    out.samples.push_back(sample);
    out.truth_mm_s2.emplace_back(-20 * w * w * std::sin(w * t), -9 * q * q * std::cos(q * t),
                                 -4 * q * q * std::sin(q * t));
  }
  return out;
}

double accelerationOff(const Track& track, const std::function<Vec3(std::size_t)>& acceleration,
                       std::size_t margin) {
  double off = 0;
  double all = 0;
  for (std::size_t i = margin; i + margin < track.samples.size(); ++i) {
    off += (acceleration(i) - track.truth_mm_s2[i]).squaredNorm();
    all += track.truth_mm_s2[i].squaredNorm();
  }
  return std::sqrt(off / all);
}

TEST(ClipMotion, TheWholeClipIsABetterWindow) {
  const Track track = swinging(0.02);
  const std::vector<Motion> whole = smoothTrack(track.samples, {}, kLookahead);
  const double with_clip = accelerationOff(
      track, [&](std::size_t i) { return whole[i].acceleration_mm_s2; }, 8);
  const double with_window = accelerationOff(
      track,
      [&](std::size_t i) { return computeMotion(track.samples, i, kLookahead).acceleration_mm_s2; },
      8);
  EXPECT_LT(with_clip, 0.4 * with_window);
  EXPECT_LT(with_clip, 0.02);
  EXPECT_NEAR(whole[100].angle_rad, track.samples[100].angle_rad, 1e-3);
  const double w = 2 * CV_PI * 0.9;
  EXPECT_NEAR(whole[100].angular_velocity_rad_s, 0.3 * w * std::cos(w * 100 / kFps), 0.01);
}

TEST(ClipMotion, BridgesGapsBetweenMeasurements) {
  Track track = swinging(0.005);
  for (std::size_t i = 60; i < 66; ++i) {
    track.samples[i].seen = false;
    track.samples[i].position_mm += Vec3(50, 50, 10);
  }
  for (std::size_t i = 120; i < 240; i += 2) {
    track.samples[i].depth_seen = false;
    track.samples[i].position_mm.z() = track.samples[i - 1].position_mm.z();
  }
  const std::vector<Motion> whole = smoothTrack(track.samples, {}, kLookahead);
  EXPECT_LT(accelerationOff(
                track, [&](std::size_t i) { return whole[i].acceleration_mm_s2; }, 8),
            0.05);
}

TEST(ClipMotion, AnImpactSetsTheVelocityFree) {
  std::vector<Sample> samples;
  const double when_s = 1.013;
  const Impact impact{mediaTime(when_s), {0, 1800, 0}};
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.01);
  for (int i = 0; i < 120; ++i) {
    const double s = i / kFps - when_s;
    Sample sample;
    sample.time_s = i / kFps;
    sample.position_mm = {30 * s + noise(random), 900 * std::abs(s) - 2000 * s * s + noise(random),
                          10 + noise(random)};
    samples.push_back(sample);
  }
  const std::vector<Motion> knows = smoothTrack(samples, {impact}, kLookahead);
  const std::vector<Motion> does_not = smoothTrack(samples, {}, kLookahead);
  double off = 0;
  double off_without = 0;
  for (std::size_t i = 50; i < 70; ++i) {
    const Vec3 truth(0, -4000, 0);
    off = std::max(off, (knows[i].acceleration_mm_s2 - truth).norm());
    off_without = std::max(off_without, (does_not[i].acceleration_mm_s2 - truth).norm());
  }
  EXPECT_LT(off, 100);
  EXPECT_GT(off_without, 10000);
  EXPECT_NEAR(knows[60].velocity_mm_s.y(), -900 - 4000 * (1.0 - when_s), 5);
  EXPECT_NEAR(knows[61].velocity_mm_s.y(), 900 - 4000 * (61 / kFps - when_s), 5);
}

TEST(ClipMotion, AnObjectAtRestHasNoMotion) {
  std::vector<Sample> samples;
  for (int i = 0; i < 120; ++i) {
    Sample sample;
    sample.time_s = i / kFps;
    const double s = std::max(0.0, i / kFps - 1.0);
    sample.position_mm = {3 + 400 * s * s, -7, 12};
    samples.push_back(sample);
  }
  const std::vector<Motion> motions = smoothTrack(samples, {}, kLookahead);
  for (std::size_t i = 0; i < 55; ++i) {
    EXPECT_EQ(motions[i].velocity_mm_s, Vec3::Zero());
    EXPECT_EQ(motions[i].acceleration_mm_s2, Vec3::Zero());
    EXPECT_EQ(motions[i].position_mm, Vec3(3, -7, 12));
  }
  EXPECT_NEAR(motions[100].acceleration_mm_s2.x(), 800, 1);
}

TEST(ClipMotion, ShortAndDegenerateTracksAreNoTrouble) {
  EXPECT_TRUE(smoothTrack({}, {}, 3).empty());
  std::vector<Sample> samples;
  for (int i = 0; i < 30; ++i) {
    Sample sample;
    sample.time_s = i / kFps;
    sample.seen = false;
    sample.position_mm = {1.0 * i, 0, 0};
    samples.push_back(sample);
    for (const Motion& motion : smoothTrack(samples, {}, 3)) {
      EXPECT_TRUE(motion.position_mm.allFinite());
      EXPECT_TRUE(motion.acceleration_mm_s2.allFinite());
    }
  }
}

TEST(ClipMotion, TheLastFramesHaveAMotionOnlyIfTheClipEndsThere) {
  const NominalFrame nominal{{}, {600, 900}};
  for (const bool ended : {true, false}) {
    ClipMotion clip;
    const auto pose = [](std::uint64_t i) {
      return ObjectPose{100.0 + 2.0 * double(i), 200, 700, 0.0, true};
    };
    for (std::uint64_t i = 0; i < 20; ++i) clip.add(5, i, double(i) / 25, pose(i), true);
    clip.smooth(nominal, 3, ended);
    const auto known = [&](std::uint64_t i) {
      return clip.at(5, i, nominal.sample(pose(i), double(i) / 25).position_mm) != nullptr;
    };
    EXPECT_TRUE(known(16));
    EXPECT_EQ(known(17), ended);
    EXPECT_EQ(known(19), ended);
  }
}

TEST(ClipMotion, ABounceOrADoubtfulPoseDoesNotCountAsAcceleration) {
  ClipMotion clip;
  const NominalFrame nominal{{}, {600, 900}};
  for (std::uint64_t i = 0; i < 40; ++i) {
    const double s = std::abs(double(i) / 25 - 0.813);
    ObjectPose pose{300, 300 - (4 * 600 * s - 4 * 500 * s * s), 700, 0.0, true};
    if (i >= 34) pose.u_px += 40.0 * double(i % 2);
    clip.add(5, i, double(i) / 25, pose, /*well=*/i < 30);
  }
  clip.smooth(nominal, 3, true);
  std::vector<double> accelerations = clip.accelerations_mm_s2(3.0 / 25);
  EXPECT_GT(accelerations.size(), 10U);
  EXPECT_NEAR(largestAcceleration_mm_s2(accelerations), 1000, 30);
  ASSERT_EQ(clip.findImpactsAround(5, 0.8, 0.1).size(), 1U);
  EXPECT_NEAR(toSeconds(clip.findImpactsAround(5, 0.8, 0.1)[0].time), 0.813, 1e-3);
  EXPECT_TRUE(clip.findImpactsAround(5, 0.5, 0.1).empty());
}

// A clip that was looked through uses all of it as the window, also with one frame of
// lookahead, and again when it loops.
TEST(ClipMotion, AScannedClipIsDeliveredSmoothed) {
  const test::BallScene scene;
  const double w = 2 * CV_PI * 1.2;
  const auto make = [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 160 + 30 * std::sin(w * double(i) / 25), 120);
    std::mt19937 random(static_cast<unsigned>(i));
    std::normal_distribution<float> noise(0.0F, 1.5F);
    for (float& z : cv::Mat_<float>(frame.depth)) z += noise(random);
    return frame;
  };
  VisionSettings settings;
  settings.depth_range = DepthRange{600, 850};
  settings.low_latency = true;
  const auto errorWith = [&](bool scan) {
    test::FunctionSource source(scene.info(), 50, make);
    Vision vision(source.info(), settings);
    if (scan) vision.scan(source, {});
    double off = 0;
    for (std::uint64_t pass = 0; pass < 2; ++pass) {
      for (std::uint64_t i = 0; i < 50; ++i) {
        const auto frame = source.read();
        const auto result = vision.push(*frame, mediaTime(double(50 * pass + i) / 25));
        if (!result || i < 8 || i > 44) continue;
        const double t = toSeconds(result->frame.media_time) - 2.0 * double(pass);
        const Motion& motion = result->frame.objects.at(0).motion;
        off += std::pow(motion.acceleration_mm_s2.x() + 15 * w * w * std::sin(w * t), 2);
      }
      source.rewind();
    }
    return std::sqrt(off / 74) / (15 * w * w / std::sqrt(2.0));
  };
  const double with_clip = errorWith(true);
  EXPECT_LT(with_clip, 0.5 * errorWith(false));
  EXPECT_LT(with_clip, 0.03);
}

}  // namespace
}  // namespace hapticast::server
