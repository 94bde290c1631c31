// SPDX-License-Identifier: MIT
#include "client/haptics/dynamic_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/frame_builder.hpp"

namespace hapticast::client {
namespace {

constexpr double kDeep_mm = 1.0;

class DynamicForceTest : public ::testing::Test {
 protected:
  Vec3 force(double time_s = 0.0, double penetration_mm = kDeep_mm,
             const Vec3& cursor = Vec3::Zero(), double scale = 1.0,
             const Vec3* contact_mm = nullptr) {
    now.before = &before;
    return dynamic.evaluate(&now, penetration_mm, cursor, mediaTime(time_s), stream, scale,
                            contact_mm);
  }

  [[nodiscard]] double mass_kg(double scale = 1.0) const {
    return dynamic.objectMass_kg(before.material, stream, scale);
  }

  DeviceProfile profile;
  DynamicForce dynamic{profile};
  StreamTiming stream;
  PlayObject before = makeObject(1, nullptr, Vec3::Zero());
  InterpolatedObject now;
};

TEST_F(DynamicForceTest, PushesTheWayTheBallAccelerates) {
  now.acceleration_mm_s2 = {0, 0, 1000};                        // towards the viewer
  EXPECT_NEAR((force() - Vec3(0, 0, 0.5)).norm(), 0.0, 1e-12);  // 0.5 kg x 1 m/s²
  now.acceleration_mm_s2 = {1000, 0, 0};                        // to the right
  EXPECT_NEAR((force() - Vec3(0.5, 0, 0)).norm(), 0.0, 1e-12);
  now.acceleration_mm_s2 = {0, 1000, 0};  // up
  EXPECT_NEAR((force() - Vec3(0, 0.5, 0)).norm(), 0.0, 1e-12);
}

TEST_F(DynamicForceTest, IsEq6) {
  now.acceleration_mm_s2 = {1000, -500, 200};
  stream.author_mass_kg = 0.6;
  stream.largest_acceleration_mm_s2 = 1500;
  const Vec3 cursor(2.0, 3.0, -1.0);
  const Vec3 expected = 0.6 * 0.8e-3 * now.acceleration_mm_s2 - 0.045 * cursor;
  EXPECT_NEAR((force(0.0, kDeep_mm, cursor, 0.8) - expected).norm(), 0.0, 1e-12);
}

TEST_F(DynamicForceTest, AnAbsurdAccelerationHasHalfOfThePeak) {
  now.acceleration_mm_s2 = {0, -1e8, 0};
  EXPECT_NEAR((force() - Vec3(0, -0.5 * profile.peak_N, 0)).norm(), 0.0, 1e-12);
}

TEST_F(DynamicForceTest, CursorMassNeverExceedsTheDevices) {
  profile.mass_kg = 0.02;
  EXPECT_NEAR(force(0.0, kDeep_mm, {1, 0, 0}).x(), -0.02, 1e-12);
}

TEST_F(DynamicForceTest, FadesInWithThePenetration) {
  now.acceleration_mm_s2 = {0, 0, 1000};
  const double full = force().z();
  EXPECT_NEAR(force(0.0, 0.05).z(), 0.25 * full, 1e-12);
  EXPECT_NEAR(force(0.0, 0.2).z(), full, 1e-12);
  EXPECT_EQ(force(0.0, 0.0).norm(), 0.0);
}

TEST_F(DynamicForceTest, ZeroWithoutContactOrNotFinite) {
  now.acceleration_mm_s2 = {0, 0, 1000};
  EXPECT_EQ(dynamic.evaluate(nullptr, 1.0, Vec3::Ones(), mediaTime(0), stream, 1.0).norm(), 0.0);
  EXPECT_EQ(force(0.0, std::numeric_limits<double>::quiet_NaN()).norm(), 0.0);
  EXPECT_EQ(force(0.0, 1.0, Vec3::Constant(std::numeric_limits<double>::quiet_NaN())).norm(), 0.0);
}

TEST_F(DynamicForceTest, MassIsTheAuthorsOrAHandfulWithinTheDevicesShare) {
  stream.largest_acceleration_mm_s2 = 1000;  // 1 m/s²: 0.88 N would allow 0.88 kg
  EXPECT_NEAR(mass_kg(), 0.5, 1e-12);
  stream.author_mass_kg = 2.0;
  EXPECT_NEAR(mass_kg(), 0.88, 1e-12);
  EXPECT_NEAR(mass_kg(0.5), 1.76, 1e-12);
  stream.author_mass_kg = 0.6;
  EXPECT_NEAR(mass_kg(), 0.6, 1e-12);
  stream.author_mass_kg = 0.05;  // never below 10 m_cursor
  EXPECT_NEAR(mass_kg(), 0.45, 1e-12);
  stream.author_mass_kg = 1000.0;
  EXPECT_NEAR(mass_kg(), 0.88, 1e-12);
  stream.largest_acceleration_mm_s2 = 1.0;
  EXPECT_NEAR(mass_kg(), 5.0, 1e-12);
  stream.largest_acceleration_mm_s2 = 20000;  // unless the device forces it
  EXPECT_NEAR(mass_kg(), 0.88 / 20, 1e-12);
  stream = StreamTiming{};
  EXPECT_NEAR(mass_kg(), 0.5, 1e-12);
  for (const double bad :
       {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), -1.0}) {
    stream.largest_acceleration_mm_s2 = stream.author_mass_kg = bad;
    EXPECT_NEAR(mass_kg(), 0.5, 1e-12);
  }
}

TEST_F(DynamicForceTest, MassOfAnObjectReplacesThatOfTheStream) {
  stream.author_mass_kg = 0.6;
  before.material.mass_kg = 1.5;
  EXPECT_NEAR(mass_kg(), 1.5, 1e-12);
  before.material.mass_kg = 1000.0;
  EXPECT_NEAR(mass_kg(), 5.0, 1e-12);
  before.material.mass_kg = 0.0;  // a mass of 0 is no mass: as if the author had stated none
  EXPECT_NEAR(mass_kg(), 0.5, 1e-12);
  now.acceleration_mm_s2 = {0, 0, 1000};
  before.material.mass_kg = 1.0;
  EXPECT_NEAR(force().z(), 1.0, 1e-12);
}

TEST_F(DynamicForceTest, NoiseOfARealStreamStaysGentle) {
  // 1300 mm/s² rms over the three axes: the largest of a clip's 250 frames is what is announced.
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1300.0 / std::sqrt(3.0));
  std::vector<Vec3> noises_mm_s2(250);
  for (Vec3& a : noises_mm_s2) {
    a = {noise(random), noise(random), noise(random)};
    stream.largest_acceleration_mm_s2 = std::max(stream.largest_acceleration_mm_s2, a.norm());
  }
  double square_N2 = 0.0;
  for (const Vec3& a : noises_mm_s2) {
    now.acceleration_mm_s2 = a;
    EXPECT_LE(force().norm(), profile.continuous_N + 1e-12);
    square_N2 += force().squaredNorm() / 250.0;
  }
  EXPECT_LT(std::sqrt(square_N2), 0.4);
}

TEST_F(DynamicForceTest, RotationAddsTheMotionAtTheContact) {
  PlayObject after = before;
  before.motion.angular_velocity_rad_s = 4.0;
  after.motion.angular_velocity_rad_s = 6.0;
  now.after = &after;
  now.blend = 0.5;
  now.blend_rate_1_s = 25.0;
  now.angular_velocity_rad_s = 5.0;
  const Vec3 contact(10.0, 0.0, 3.0);
  // Centripetal -25 x 10 along x, tangential 50 rad/s² x 10 along y, mm/s².
  const Vec3 expected = 0.5e-3 * Vec3(-250.0, 500.0, 0.0);
  EXPECT_NEAR((force(0.0, kDeep_mm, Vec3::Zero(), 1.0, &contact) - expected).norm(), 0.0, 1e-12);
  EXPECT_EQ(force().norm(), 0.0);  // at the reference point
}

TEST_F(DynamicForceTest, AddsTheGridAtTheContactCarriedBack) {
  MotionGrid grid;
  grid.columns = 3;
  grid.rows = 2;
  for (int cell = 0; cell < 6; ++cell) {
    grid.velocity_mm_s.push_back(Eigen::Vector3f::Zero());
    const int row = cell / 3;
    grid.acceleration_mm_s2.push_back(Eigen::Vector3f(100.0F * static_cast<float>(cell % 3),
                                                      1000.0F * static_cast<float>(row), 0.0F));
  }
  before.grid = &grid;
  before.grid_rect = {304, 224, 48, 32};
  now.position_mm = {2.0, 0.0, 0.0};  // moved on by 8 px since the frame
  const auto computeForce = [&](double u, double v) {
    const Vec2 at = stream.workspace.toNominal({u + 8.0, v});
    const Vec3 contact(at.x(), at.y(), 0.0);
    return Vec3(force(0.0, kDeep_mm, Vec3::Zero(), 1.0, &contact) / 0.5e-3);
  };
  EXPECT_NEAR((computeForce(312, 232) - Vec3(0, 0, 0)).norm(), 0.0,
              1e-9);  // centre of the first cell
  EXPECT_NEAR((computeForce(328, 240) - Vec3(100, 500, 0)).norm(), 0.0,
              1e-9);  // second column, between the rows
  EXPECT_NEAR((computeForce(336, 248) - Vec3(150, 1000, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((computeForce(9999, 9999) - Vec3(200, 1000, 0)).norm(), 0.0, 1e-9);
  grid.acceleration_mm_s2.resize(2);  // shorter than announced
  EXPECT_EQ(computeForce(312, 232).norm(), 0.0);
}

TEST_F(DynamicForceTest, AnImpactIsAHalfSineAlongItsChangeOfVelocity) {
  // 3 mm/s: 15 ms are long enough. 30 and 40 mm/s: longer, so that the rise fits the slew limit.
  struct Case {
    double change_mm_s, length_ms;
  };
  for (const auto& [change_mm_s, length_ms] : {Case{3.0, 15.0}, {30.0, 21.6}, {40.0, 24.9}}) {
    const double begin_s = change_mm_s;
    before.impacts[0] = {mediaTime(begin_s), {0, 0, change_mm_s}};
    before.impact_count = 1;
    double area = 0.0;
    double rise = 0.0;
    double last = 0.0;
    for (int tick = -5; tick < 60; ++tick) {
      const Vec3 f = force(begin_s + tick * 1e-3);
      EXPECT_GE(f.z(), 0.0);
      EXPECT_EQ(f.head<2>().norm(), 0.0);
      if (tick < 0 || tick > length_ms) {
        EXPECT_EQ(f.z(), 0.0) << tick;
      }
      area += f.z() * 1e-3;
      rise = std::max(rise, f.z() - std::exchange(last, f.z()));
    }
    const double impulse = 0.5e-3 * change_mm_s;  // m |dv|
    EXPECT_NEAR(area, impulse, 0.01 * impulse) << change_mm_s;
    EXPECT_LE(rise, 0.8 * profile.slew_rise_N_per_tick + 1e-9) << change_mm_s;
  }
}

TEST_F(DynamicForceTest, APulseBeginsAtZeroInTheFirstTickThatKnowsTheImpact) {
  before.impacts[0] = {mediaTime(1.0), {0, 0, 40}};
  before.impact_count = 1;
  EXPECT_EQ(force(1.012).z(), 0.0);  // the frame came late
  EXPECT_GT(force(1.013).z(), 0.0);
  EXPECT_LE(force(1.013).z(), 0.8 * profile.slew_rise_N_per_tick);
  before.impacts[0].time = mediaTime(2.0);
  EXPECT_EQ(force(2.016).z(), 0.0);  // too late
  EXPECT_EQ(force(2.020).z(), 0.0);
}

TEST_F(DynamicForceTest, AHardImpactIsCompressedUnderThePulseLimit) {
  before.impact_count = 1;
  double last = 0.0;
  for (const double dv : {100.0, 500.0, 3000.0}) {
    before.impacts[0] = {mediaTime(dv), {0, -dv, 0}};
    double peak = 0.0;
    for (int tick = 0; tick < 45; ++tick) peak = std::max(peak, -force(dv + tick * 1e-3).y());
    EXPECT_GT(peak, last);  // harder stays harder
    EXPECT_LE(peak, profile.pulse_limit_N);
    last = peak;
  }
  EXPECT_GT(last, 0.99 * profile.pulse_limit_N);
}

TEST_F(DynamicForceTest, AnImpactIsRenderedOnceThoughFramesDisagreeOrForgetIt) {
  before.impacts[0] = {mediaTime(1.0), {0, 0, 50}};
  before.impact_count = 1;
  PlayObject after = before;
  after.impacts[0].time = mediaTime(1.002);  // estimated anew
  now.after = &after;
  EXPECT_EQ(force(1.0).z(), 0.0);
  const double rising = force(1.007).z();
  EXPECT_GT(force(1.014).z(), rising);
  before.impact_count = after.impact_count = 0;
  EXPECT_GT(force(1.020).z(), 0.0);
  before = after;
  before.impact_count = 1;
  EXPECT_EQ(force(1.029).norm(), 0.0);
  // Soon over, though the later estimate is under way.
  before.impacts[0] = {mediaTime(3.0), {0, 0, 3}};
  (void)force(3.0);
  before.impacts[0].time = mediaTime(3.002);
  EXPECT_EQ(force(3.0155).norm(), 0.0);
  before.impacts[0].time = mediaTime(3.1);
  (void)force(3.1);
  EXPECT_GT(force(3.1075).z(), 0.0);  // another one
}

TEST_F(DynamicForceTest, AnImpactIsDoubtedByItsRenderedShare) {
  before.impact_count = 1;
  const auto doubts = [&](double time_s, double logged_mm_s, double plausible_mm_s) {
    before.impacts[0] = {mediaTime(time_s), {0, 0, logged_mm_s}};
    now.plausibility.impact_mm_s = plausible_mm_s;
    (void)force(time_s);
    return dynamic.implausible();
  };
  EXPECT_FALSE(doubts(1.0, 20.0, 19.8)) << "0.01 N less";
  EXPECT_TRUE(doubts(2.0, 20.0, 18.0)) << "0.05 N less";
  EXPECT_TRUE(doubts(3.0, 1e300, 20.0));
}

TEST_F(DynamicForceTest, AlwaysFiniteAndWithinThePeak) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-300.0, 300.0);
  const auto draw = [&] {
    switch (random() % 12) {
      case 0:
        return std::numeric_limits<double>::quiet_NaN();
      case 1:
        return std::numeric_limits<double>::infinity();
      case 2:
        return 0.0;
      default:
        return (random() % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(random));
    }
  };
  for (int i = 0; i < 50000; ++i) {
    now.position_mm = {draw(), draw(), draw()};
    now.acceleration_mm_s2 = {draw(), draw(), draw()};
    now.angular_velocity_rad_s = draw();
    before.impacts[0] = {mediaTime(i), {draw(), draw(), draw()}};
    before.impact_count = 1;
    stream.author_mass_kg = draw();
    stream.largest_acceleration_mm_s2 = draw();
    const Vec3 contact(draw(), draw(), draw());
    const double mass = dynamic.objectMass_kg(before.material, stream, draw());
    ASSERT_TRUE(std::isfinite(mass) && mass >= 0.0);
    const Vec3 f = force(i + 0.007, draw(), {draw(), draw(), draw()}, draw(), &contact);
    ASSERT_TRUE(f.allFinite());
    ASSERT_LE(f.norm(), profile.peak_N * (1 + 1e-12));
  }
}

}  // namespace
}  // namespace hapticast::client
