// SPDX-License-Identifier: MIT
#include "server/vision/motion/impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "server/source/synthetic/synthetic_scene.hpp"
#include "server/vision/frame_motion.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

struct Findings {
  std::vector<Impact> impacts;  // each once
  // Frames right before and after an impact, and how many of them carried it.
  int before = 0, logged_before = 0, after = 0, logged_after = 0;
};

// As the stream does it: a window of three frames on either side.
Findings findAll(const std::vector<Sample>& samples) {
  Findings out;
  ImpactFinder finder;
  std::vector<std::vector<Impact>> found;
  for (std::size_t at = 0; at < samples.size(); ++at) {
    const std::size_t first = at > 3 ? at - 3 : 0;
    const std::size_t last = std::min(samples.size() - 1, at + 3);
    finder.test(
        {samples.begin() + std::ptrdiff_t(first), samples.begin() + std::ptrdiff_t(last + 1)},
        at - first);
    found.push_back(finder.findAround(samples[at].time_s, 3.5 * 0.04));
    for (const Impact& impact : found.back()) {
      const bool is_new = out.impacts.empty() || impact.time > out.impacts.back().time;
      if (is_new) out.impacts.push_back(impact);
    }
  }
  for (const Impact& impact : out.impacts) {
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
      if (toSeconds(impact.time) < samples[i].time_s ||
          toSeconds(impact.time) >= samples[i + 1].time_s)
        continue;
      const auto has = [&](const std::vector<Impact>& list) {
        return std::any_of(list.begin(), list.end(),
                           [&](const Impact& one) { return one.time == impact.time; });
      };
      ++out.before;
      ++out.after;
      out.logged_before += has(found[i]) ? 1 : 0;
      out.logged_after += has(found[i + 1]) ? 1 : 0;
    }
  }
  return out;
}

std::vector<Sample> noisySamples(int count, double noise_mm,
                                 const std::function<Vec3(double)>& position) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, noise_mm);
  std::vector<Sample> out;
  for (int i = 0; i < count; ++i) {
    const Vec3 off =
        noise_mm > 0 ? Vec3(noise(random), noise(random), noise(random)) : Vec3::Zero();
    out.push_back({i / 25.0, position(i / 25.0) + off, 0.0, true});
  }
  return out;
}

// Falls with 2000 mm/s² and bounces at `when` with 600 mm/s.
std::vector<Sample> bounceAt(double when, double noise_mm) {
  return noisySamples(24, noise_mm, [when](double t) {
    const double s = std::abs(t - when);
    return Vec3(40 * t, 600 * s - 1000 * s * s, 5);
  });
}

TEST(Impact, ABounceIsFoundOnceWhereverItFallsBetweenFrames) {
  for (double place = 0.0; place < 1.0; place += 0.05) {
    const double when = (10 + place) / 25;
    const Findings found = findAll(bounceAt(when, 0.0));
    ASSERT_EQ(found.impacts.size(), 1U) << place;
    EXPECT_NEAR(toSeconds(found.impacts[0].time), when, 1e-4) << place;
    EXPECT_LT((found.impacts[0].delta_velocity_mm_s - Vec3(0, 1200, 0)).norm(), 5) << place;
    EXPECT_EQ(found.logged_after, found.after) << place;
    // Only one that falls next to the later frame has to wait for what that frame shows.
    if (place < 0.84) {
      EXPECT_EQ(found.logged_before, found.before) << place;
    }
  }
}

TEST(Impact, NoiseMovesItLittle) {
  for (const double when : {0.404, 0.42, 0.436}) {
    const Findings found = findAll(bounceAt(when, 0.05));
    ASSERT_EQ(found.impacts.size(), 1U) << when;
    EXPECT_NEAR(toSeconds(found.impacts[0].time), when, 1e-3);
    EXPECT_LT((found.impacts[0].delta_velocity_mm_s - Vec3(0, 1200, 0)).norm(), 60);
  }
}

TEST(Impact, SmoothMotionAndNoiseAreNone) {
  const auto lissajous = [](double t) {
    return Vec3(40 * std::sin(9 * t), 30 * std::cos(7 * t), 10 * std::sin(11 * t));
  };
  EXPECT_TRUE(findAll(noisySamples(250, 0.0, lissajous)).impacts.empty());
  EXPECT_TRUE(findAll(noisySamples(250, 0.1, lissajous)).impacts.empty());
  EXPECT_TRUE(
      findAll(noisySamples(500, 0.3, [](double) { return Vec3(1, 2, 3); })).impacts.empty());
}

TEST(Impact, AStepOfThePositionIsNone) {
  const auto jump = [](double t) { return Vec3(t < 0.41 ? 0.0 : 8.0, 0, 0); };
  EXPECT_TRUE(findAll(noisySamples(24, 0.0, jump)).impacts.empty());
}

TEST(Impact, MissingFramesAndEqualTimesAreSurvived) {
  std::vector<Sample> samples = bounceAt(0.42, 0.0);
  samples.erase(samples.begin() + 10, samples.begin() + 14);
  samples[5].time_s = samples[4].time_s;
  EXPECT_TRUE(findAll(samples).impacts.empty());
  EXPECT_TRUE(findAll({samples[0]}).impacts.empty());
}

TEST(Impact, AllOfASceneAreFoundAndNoOthers) {
  Workspace workspace;
  const SyntheticScene scene(SceneKind::kBounce, workspace);
  std::vector<Sample> samples;
  const int count = static_cast<int>(scene.duration_s() * 25);
  samples.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i)
    samples.push_back({i / 25.0, scene.at(i / 25.0).motion().position_mm, 0.0, true});
  const Findings found = findAll(samples);
  std::size_t next = 0;
  for (const SceneImpact& truth : scene.impacts()) {
    // Without three frames on both sides of its own there is nothing to see.
    if (truth.time_s < 0.12 || truth.time_s > scene.duration_s() - 0.16) continue;
    ASSERT_LT(next, found.impacts.size()) << truth.time_s;
    EXPECT_NEAR(toSeconds(found.impacts[next].time), truth.time_s, 5e-4);
    EXPECT_LT((found.impacts[next].delta_velocity_mm_s - truth.delta_velocity_mm_s).norm(),
              0.02 * truth.delta_velocity_mm_s.norm());
    ++next;
  }
  EXPECT_EQ(next, found.impacts.size());
  EXPECT_GT(next, 2U);
}

TEST(Impact, TheLargestAccelerationLeavesOutTheWorstHundredth) {
  std::vector<double> values(301, 50.0);
  values[7] = 1e6;
  EXPECT_EQ(largestAcceleration_mm_s2(values), 50.0);
  std::vector<double> few{1.0, 3.0, 2.0};
  EXPECT_EQ(largestAcceleration_mm_s2(few), 3.0);
  std::vector<double> none;
  EXPECT_EQ(largestAcceleration_mm_s2(none), 0.0);
}

}  // namespace
}  // namespace hapticast::server
