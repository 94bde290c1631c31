// SPDX-License-Identifier: MIT
// The plausibility bounds: motion that successive frames support, and motion of one frame only.
#include "client/haptics/playback/plausibility_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/frame_builder.hpp"

namespace hapticast::client {
namespace {

constexpr double kStep_s = 0.04;
using MotionAt = std::function<Motion(double time_s)>;

class PlausibilityTest : public ::testing::Test {
 protected:
  /// Five frames of a body whose relief moves with it, the third at `time_s`.
  PlausibilityBounds of(const MotionAt& motion, double time_s, bool moves = true) {
    ObjectHistory seen;
    for (std::size_t i = 0; i < ObjectHistory::kFrames; ++i) {
      objects_[i] = PlayObject{};
      objects_[i].motion = motion(time_s + kStep_s * (static_cast<double>(i) - 2.0));
      objects_[i].field = &fields_[moves ? i : 0];
      seen.object[i] = &objects_[i];
    }
    seen.interval_s.fill(kStep_s);
    return computePlausibilityBounds(seen);
  }
  static MotionAt swinging(double hz, double amplitude_mm) {
    return [=](double t) {
      const double w = 2.0 * M_PI * hz;
      Motion motion;
      motion.position_mm.z() = amplitude_mm * std::sin(w * t);
      motion.velocity_mm_s.z() = amplitude_mm * w * std::cos(w * t);
      motion.acceleration_mm_s2.z() = -amplitude_mm * w * w * std::sin(w * t);
      return motion;
    };
  }

  std::array<PlayObject, ObjectHistory::kFrames> objects_;
  std::array<HeightField, ObjectHistory::kFrames> fields_;
};

TEST_F(PlausibilityTest, ABodyAtRestHasNoAccelerationWhateverTheStreamSends) {
  Motion false_stream;
  false_stream.acceleration_mm_s2.z() = 1e8;
  const PlausibilityBounds plausibility = of([&](double) { return false_stream; }, 1.0);
  EXPECT_EQ(plausibility.acceleration_mm_s2, 0.0);
  EXPECT_EQ(plausibility.impact_mm_s, 0.0);
  EXPECT_EQ(plausibility.turn_rad_s, 0.0);
  EXPECT_EQ(plausibility.turn_rate_rad_s2, 0.0);
}

TEST_F(PlausibilityTest, RejectsVelocitiesThatThePositionsDoNotFollow) {
  const PlausibilityBounds plausibility = of(
      [](double t) {
        Motion motion;
        motion.velocity_mm_s.x() = std::fmod(t, 0.08) < 0.04 ? 1000.0 : -1000.0;
        motion.angular_velocity_rad_s = motion.velocity_mm_s.x();
        return motion;
      },
      1.0);
  EXPECT_EQ(plausibility.acceleration_mm_s2, 0.0);
  EXPECT_EQ(plausibility.impact_mm_s, 0.0);
  EXPECT_EQ(plausibility.turn_rate_rad_s2, 0.0);
}

TEST_F(PlausibilityTest, RejectsPositionsThatTheReliefDoesNotFollow) {
  const PlausibilityBounds plausibility = of(swinging(4.0, 5.0), 1.0, /*moves=*/false);
  EXPECT_EQ(plausibility.acceleration_mm_s2, 0.0);
  EXPECT_EQ(plausibility.grid_mm_s2, 0.0);
}

TEST_F(PlausibilityTest, AcceptsAPlausibleSwingAtEveryPhase) {
  for (const double hz : {0.5, 1.0, 2.0, 3.0, 4.0, 6.0}) {
    for (int i = 0; i < 100; ++i) {
      const double time_s = i * 0.013;
      const PlausibilityBounds plausibility = of(swinging(hz, 5.0), time_s);
      const Motion announced = swinging(hz, 5.0)(time_s);
      EXPECT_GE(plausibility.acceleration_mm_s2, announced.acceleration_mm_s2.norm())
          << hz << " Hz at " << time_s;
      const double w = 2.0 * M_PI * hz;
      EXPECT_LE(plausibility.acceleration_mm_s2, 3.1 * 5.0 * w * w) << hz << " Hz at " << time_s;
    }
  }
}

TEST_F(PlausibilityTest, AcceptsAPlausibleBounce) {
  for (const double into : {0.1, 0.5, 0.9}) {  // of the interval
    const double hit_s = 1.0 + into * kStep_s;
    const PlausibilityBounds plausibility = of(
        [=](double t) {
          const double speed_mm_s = t < hit_s ? -400.0 : 400.0;
          Motion motion;
          motion.position_mm.z() = speed_mm_s * (t - hit_s);
          motion.velocity_mm_s.z() = speed_mm_s;
          return motion;
        },
        1.0);
    EXPECT_GE(plausibility.impact_mm_s, 800.0) << into;
    EXPECT_LE(plausibility.impact_mm_s, 2.0 * 800.0) << into;
  }
}

TEST_F(PlausibilityTest, RejectsFramesThatAreCloserThanThoseOfAnyStream) {
  ObjectHistory seen;
  for (std::size_t i = 0; i < ObjectHistory::kFrames; ++i) {
    objects_[i].motion.position_mm.z() = i % 2 == 0 ? 10.0 : 10.01;
    objects_[i].field = &fields_[i];
    seen.object[i] = &objects_[i];
  }
  seen.interval_s = {1e-6, 0.08, 1e-6, 0.08};
  EXPECT_LE(computePlausibilityBounds(seen).acceleration_mm_s2, 20.0);
  seen.interval_s.fill(1.0 / 240.0);
  EXPECT_GE(computePlausibilityBounds(seen).acceleration_mm_s2, 0.02 * 240.0 * 240.0)
      << "the fastest stream's do";
}

TEST_F(PlausibilityTest, WithoutNeighboursOnlyTheFramePresentCounts) {
  const PlayObject alone;
  ObjectHistory seen;
  seen.object[ObjectHistory::kNow] = &alone;
  const PlausibilityBounds plausibility = computePlausibilityBounds(seen);
  EXPECT_EQ(plausibility.acceleration_mm_s2, 0.0);
  EXPECT_EQ(plausibility.impact_mm_s, 0.0);
}

}  // namespace
}  // namespace hapticast::client
