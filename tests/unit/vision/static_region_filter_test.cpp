// SPDX-License-Identifier: MIT
#include "server/vision/surface/static_region_filter.hpp"

#include <gtest/gtest.h>

#include "server/vision/vision.hpp"
#include "tests/scenes/noisy_ball.hpp"

namespace hapticast::server {
namespace {

using test::kSigma_mm;
using test::NoisyBall;

constexpr double kGain = 0.1;  // nominal mm per mm of depth
constexpr double kStiffness_N_mm = 0.5;

// The frames of a ball through Hold; beside it what they are without.
struct Holding {
  NoisyBall ball;
  StaticRegionFilter hold;
  DepthNoise noise{{kSigma_mm}, 0.0};
  Surface held;
  Surface free;
  std::uint64_t index = 0;

  void next(double u, double v = 120, double closer_mm = 0, bool repeated = false) {
    const FrameImages view =
        makeFrameImages(ball.frame(index++, u, v, closer_mm), ball.scene.info());
    free = cleanSurface(view.depth, view.mask * 255, noise, Method::kHapticast);
    held = hold.apply(view.gray, free, {kSigma_mm}, repeated);
  }
  // Root mean square of the depth's error, mm, 5 px and more inside the ball.
  [[nodiscard]] double error_mm(const Surface& surface, double u, double v = 120,
                                double closer_mm = 0) const {
    double sum = 0;
    int count = 0;
    for (int j = 0; j < surface.box.height; ++j) {
      for (int i = 0; i < surface.box.width; ++i) {
        const double du = surface.box.x + i + 0.5 - u;
        const double dv = surface.box.y + j + 0.5 - v;
        if (std::hypot(du, dv) > ball.scene.radius_px - 5) continue;
        if (surface.mask.at<uchar>(j, i) == 0) return 1e3;  // not where the ball is
        const double off = double(surface.depth.at<float>(j, i)) -
                           ball.scene.ballDepth({u + du, v + dv}, {u, v}, closer_mm);
        sum += off * off;
        ++count;
      }
    }
    return std::sqrt(sum / std::max(1, count));
  }
};

bool equalSurfaces(const Surface& a, const Surface& b) {
  return a.box == b.box && equalImages(a.mask, b.mask) && equalImages(a.depth, b.depth) &&
         equalImages(a.measured, b.measured);
}

TEST(StaticRegionFilter, AStillObjectIsPerfectlyStillAfterSixteenFrames) {
  Holding run;
  for (int i = 0; i < 17; ++i) run.next(160);
  const Surface settled = run.held;
  const Surface free = run.free;
  for (int i = 17; i < 60; ++i) {
    run.next(160);
    EXPECT_EQ(run.hold.share(), 1.0) << i;
    EXPECT_TRUE(equalSurfaces(run.held, settled)) << i;
  }
  EXPECT_FALSE(equalSurfaces(run.free, free));
  // It is not only still but also right: sixteen frames are averaged.
  EXPECT_LT(run.error_mm(run.held, 160), 0.4 * run.error_mm(run.free, 160));
}

TEST(StaticRegionFilter, AnObjectThatStartsToMoveIsReleasedAtOnce) {
  Holding run;
  for (int i = 0; i < 25; ++i) run.next(160);
  ASSERT_EQ(run.hold.share(), 1.0);
  for (int i = 1; i <= 12; ++i) {
    run.next(160 + i);
    EXPECT_LT(run.hold.share(), i < 2 ? 0.5 : 0.02) << i;
    if (i < 2) continue;
    EXPECT_LT(run.error_mm(run.held, 160 + i), 1.03 * run.error_mm(run.free, 160 + i)) << i;
  }
}

TEST(StaticRegionFilter, AClipThatStartsInMotionIsNotHeld) {
  for (const double step_px : {0.25, 0.5, 1.0, 3.0}) {
    Holding run;
    double held = 0;
    double free = 0;
    for (int i = 0; i < 20; ++i) {
      run.next(130 + step_px * i);
      EXPECT_LT(run.hold.share(), 0.01) << i;  // a sliver of the rim that slides along itself
      held += run.error_mm(run.held, 130 + step_px * i);
      free += run.error_mm(run.free, 130 + step_px * i);
    }
    EXPECT_LT(held, 1.03 * free) << step_px << " px a frame";
  }
}

TEST(StaticRegionFilter, ASlowDriftInDepthIsNoticed) {
  Holding run;
  for (int i = 0; i < 25; ++i) run.next(160);
  double worst_mm = 0;
  for (int i = 1; i <= 40; ++i) {
    run.next(160, 120, 0.5 * i);
    double sum = 0;
    int count = 0;
    for (int v = -40; v <= 40; ++v) {
      for (int u = -40; u <= 40; ++u) {
        const cv::Point at(160 + u - run.held.box.x, 120 + v - run.held.box.y);
        sum += double(run.held.depth.at<float>(at)) -
               run.ball.scene.ballDepth({160 + u + 0.5, 120 + v + 0.5}, {160, 120}, 0.5 * i);
        ++count;
      }
    }
    worst_mm = std::max(worst_mm, std::abs(sum / count));
  }
  RecordProperty("worst_mm", std::to_string(worst_mm));
  EXPECT_LT(worst_mm, 3.0);
}

TEST(StaticRegionFilter, AFastMoveInDepthIsReleasedAtOnce) {
  Holding run;
  for (int i = 0; i < 25; ++i) run.next(160);
  for (int i = 1; i <= 6; ++i) {
    run.next(160, 120, 4.0 * i);
    EXPECT_EQ(run.hold.share(), 0.0) << i;
    if (i < 2) continue;
    EXPECT_LT(run.error_mm(run.held, 160, 120, 4.0 * i),
              1.03 * run.error_mm(run.free, 160, 120, 4.0 * i))
        << i;
  }
}

TEST(StaticRegionFilter, AStepInBrightnessReleasesNothing) {
  Holding run;
  for (int i = 0; i < 25; ++i) run.next(160);
  const Surface settled = run.held;
  run.ball.brightness = 0.85;
  for (int i = 0; i < 5; ++i) {
    run.next(160);
    EXPECT_TRUE(equalSurfaces(run.held, settled)) << i;
  }
}

TEST(StaticRegionFilter, ABodyAtRestIsHeldBesideAHandThatMoves) {
  Holding run;
  double least = 1.0;
  for (int i = 0; i < 40; ++i) {
    const FrameImages view =
        makeFrameImages(run.ball.frame(std::uint64_t(i), 160, 120, 0), run.ball.scene.info());
    cv::Mat gray = view.gray.clone();
    cv::Mat depth = view.depth.clone();
    const cv::Rect hand(130 + i % 8, 90, 24, 24);
    cv::rectangle(gray, hand, 30, cv::FILLED);
    cv::rectangle(depth, hand, 690, cv::FILLED);
    const Surface now = cleanSurface(depth, view.mask * 255, run.noise, Method::kHapticast);
    run.held = run.hold.apply(gray, now, {kSigma_mm}, false);
    if (i >= 20) least = std::min(least, run.hold.share());
    EXPECT_LT(run.hold.share(), 1.0);
  }
  EXPECT_GT(least, 0.3);
}

TEST(StaticRegionFilter, APixelThatTheSensorMissesForAFrameStaysMeasured) {
  Holding run;
  for (int i = 0; i < 6; ++i) run.next(160);
  const cv::Rect hole(150, 110, 4, 4);
  const FrameImages view =
      makeFrameImages(run.ball.frame(run.index, 160, 120, 0), run.ball.scene.info());
  cv::Mat depth = view.depth.clone();
  depth(hole).setTo(0);
  const Surface now = cleanSurface(depth, view.mask * 255, run.noise, Method::kHapticast);
  ASSERT_EQ(cv::countNonZero(now.measured(hole - now.box.tl())), 0);
  const Surface held = run.hold.apply(view.gray, now, {kSigma_mm}, false);
  EXPECT_EQ(cv::countNonZero(held.measured(hole - held.box.tl())), hole.area());
  EXPECT_TRUE(
      equalImages(held.depth(hole - held.box.tl()), run.held.depth(hole - run.held.box.tl())));
}

TEST(StaticRegionFilter, RepeatedDepthDoesNotCount) {
  Holding run;
  run.next(160);
  for (int i = 0; i < 30; ++i) run.next(160, 120, 0, true);
  EXPECT_LT(run.error_mm(run.held, 160) / run.error_mm(run.free, 160), 1.2);
  EXPECT_GT(run.error_mm(run.held, 160) / run.error_mm(run.free, 160), 0.8);
}

// A clean depth has no drift that would hide the slow moments of a motion.
TEST(StaticRegionFilter, CleanDepthThatTurnsRoundIsFollowed) {
  const auto worst_mm = [](const StaticNoise& noise) {
    Holding run;
    double worst = 0.0;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const double closer_mm = 40.0 * std::cos(0.1 * double(i));
      const FrameImages view =
          makeFrameImages(run.ball.scene.frame(i, 160, 120, closer_mm), run.ball.scene.info());
      const Surface now = rawSurface(view.depth, view.mask * 255, {{0.02}, 0.0});
      run.held = run.hold.apply(view.gray, now, noise, false);
      worst = std::max(worst, run.error_mm(run.held, 160, 120, closer_mm));
    }
    return worst;
  };
  EXPECT_LT(worst_mm({.sigma_mm = 0.02, .drift_mm = 0.0}), 0.25);
  EXPECT_GT(worst_mm({.sigma_mm = 0.02}), 0.6);
}

// Through all of vision: the force and the data at rest.
struct StillRun {
  double force_noise_N = 0.0;  // root mean square over pixels and frames 20 ..
  std::size_t changed = 0;     // frames from 20 on whose relief is another
  bool moves = false;
};

StillRun runStill(Method method, bool with_mask = true) {
  const NoisyBall ball;
  VisionSettings settings;
  settings.object_points = {{{160, 120}}};
  settings.method = method;
  settings.depth_range = DepthRange{600, 600 + 30 / kGain};
  Vision vision(ball.scene.info(), settings);
  std::vector<HapticObject> objects;
  for (std::uint64_t i = 0; i < 40; ++i) {
    RgbdFrame frame = ball.frame(i, 160, 120, 0);
    if (!with_mask) frame.mask.release();
    const auto result = vision.push(frame, mediaTime(double(i) / 25));
    if (result) objects.push_back(result->frame.objects.at(0));
  }
  StillRun out;
  double sum = 0;
  double count = 0;
  for (std::size_t i = 21; i < objects.size(); ++i) {
    const Relief& relief = *objects[i].relief;
    const Relief& before = *objects[i - 1].relief;
    out.changed += relief.height_mm == before.height_mm && relief.mask == before.mask ? 0 : 1;
    out.moves = out.moves || objects[i].motion.velocity_mm_s != Vec3::Zero() ||
                objects[i].motion.angular_velocity_rad_s != 0.0;
    for (int v = 80; v < 160; ++v) {
      for (int u = 120; u < 200; ++u) {
        const auto at = [&](const Relief& r) {
          return double(r.height_mm[std::size_t((v - r.rect.v) * r.rect.width + u - r.rect.u)]);
        };
        const double delta = (at(relief) - at(before)) / std::sqrt(2.0);
        sum += delta * delta;
        ++count;
      }
    }
  }
  out.force_noise_N = kStiffness_N_mm * std::sqrt(sum / count);
  return out;
}

TEST(StaticRegionFilter, AStillSceneHasNoForceNoiseNoMotionAndNothingToSend) {
  const StillRun held = runStill(Method::kHapticast);
  EXPECT_EQ(held.force_noise_N, 0.0);
  EXPECT_EQ(held.changed, 0U);
  EXPECT_FALSE(held.moves);
  const StillRun thesis = runStill(Method::kThesis);
  RecordProperty("thesis_force_noise_N", std::to_string(thesis.force_noise_N));
  EXPECT_GT(thesis.force_noise_N, 0.005);
  EXPECT_GT(thesis.changed, 10U);
}

TEST(StaticRegionFilter, AStillSceneIsStillWithMasksOfOurOwn) {
  const StillRun held = runStill(Method::kHapticast, false);
  EXPECT_EQ(held.force_noise_N, 0.0);
  EXPECT_EQ(held.changed, 0U);
  EXPECT_FALSE(held.moves);
}

}  // namespace
}  // namespace hapticast::server
