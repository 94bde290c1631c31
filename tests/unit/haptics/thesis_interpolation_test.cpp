// SPDX-License-Identifier: MIT
#include "client/haptics/contact/thesis_interpolation.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/frame_builder.hpp"

namespace hapticast::client {
namespace {

/// A flat plate that stands higher by frames; hip under all of them.
class ThesisInterpolationTest : public ::testing::Test {
 protected:
  void sendPlate(std::uint64_t id, double height_mm, std::uint32_t epoch = 1) {
    fields.push_back(makeField(
        {300, 220, 40, 40}, kWorkspace, [=](const Vec2&) { return height_mm; },
        [](const Vec2&) { return true; }));
    PlayObject object = makeObject(4, fields.back().get(), Vec3::Zero());
    object.motion.acceleration_mm_s2 = {0, 0, 100.0 * height_mm};
    ASSERT_TRUE(send(*pool, makeFrame(epoch, id, 0.04 * static_cast<double>(id), {object})));
  }
  Contact at(double time_s, const Vec3& hip) {
    (void)lookup.at(mediaTime(time_s), stream);
    return thesis.evaluate(lookup, mediaTime(time_s), hip, kWorkspace);
  }

  std::vector<std::shared_ptr<const HeightField>> fields;
  std::unique_ptr<FramePool> pool = std::make_unique<FramePool>();
  SceneInterpolator lookup{*pool, Interpolation::kHermite};
  ThesisInterpolation thesis;
  StreamTiming stream;
};

TEST_F(ThesisInterpolationTest, CatmullRomReproducesAParabola) {
  const auto height = [](double i) { return 5.0 + 0.5 * i + 0.25 * i * i; };
  for (std::uint64_t i = 0; i < 4; ++i) sendPlate(i, height(static_cast<double>(i)));
  for (double s = 0.0; s < 1.0; s += 0.05) {
    const Contact contact = at(0.04 * (1.0 + s) + 1e-9, {0, 0, 3});
    ASSERT_TRUE(contact.contact);
    EXPECT_NEAR(contact.displacement_mm.z(), height(1 + s) - 3.0, 1e-5);
    EXPECT_NEAR(contact.object->acceleration_mm_s2.z(),
                100.0 * ((1 - s) * height(1) + s * height(2)), 1e-3);
    EXPECT_EQ(contact.surface_velocity_mm_s.norm(), 0.0);
  }
}

TEST_F(ThesisInterpolationTest, LinearOrHeldWhereNeighboursAreMissing) {
  sendPlate(0, 5.0);
  EXPECT_NEAR(at(0.01, {0, 0, 3}).displacement_mm.z(), 2.0, 1e-6);
  sendPlate(1, 7.0);
  EXPECT_NEAR(at(0.01, {0, 0, 3}).displacement_mm.z(), 2.5, 1e-6);
  EXPECT_NEAR(at(0.05, {0, 0, 3}).displacement_mm.z(), 4.0, 1e-6);
}

TEST_F(ThesisInterpolationTest, TheHipStandsStillWithinAnInterval) {
  for (std::uint64_t i = 0; i < 6; ++i) sendPlate(i, 10.0);
  EXPECT_NEAR(at(0.081, {0, 0, 9}).displacement_mm.z(), 1.0, 1e-6);
  EXPECT_NEAR(at(0.119, {0, 0, 5}).displacement_mm.z(), 1.0, 1e-6);
  EXPECT_NEAR(at(0.121, {0, 0, 5}).displacement_mm.z(), 5.0, 1e-6);
}

TEST_F(ThesisInterpolationTest, NothingOutsideTheMaskAboveTheSurfaceOrBeforeTheStream) {
  EXPECT_FALSE(at(0.0, {0, 0, 3}).contact);
  for (std::uint64_t i = 0; i < 6; ++i) sendPlate(i, 10.0);
  EXPECT_FALSE(at(0.05, {0, 0, 11}).contact);
  EXPECT_FALSE(at(0.09, {30, 0, 3}).contact);
}

TEST_F(ThesisInterpolationTest, NeverPullsWhereTheCubicSwingsBelowZero) {
  // Touched at i + 2 only: the cubic undershoots in [i, i + 1].
  for (std::uint64_t i = 0; i < 3; ++i) sendPlate(i, 1.0);
  sendPlate(3, 25.0);
  for (double t = 0.041; t < 0.08; t += 0.002) EXPECT_FALSE(at(t, {0, 0, 5}).contact);
}

TEST_F(ThesisInterpolationTest, JumpsAtANewEpochOnly) {
  sendPlate(0, 10.0);
  sendPlate(1, 10.0);
  sendPlate(2, 10.0, 2);
  EXPECT_TRUE(at(0.001, {0, 0, 9}).jump);
  EXPECT_FALSE(at(0.002, {0, 0, 9}).jump);
  EXPECT_FALSE(at(0.05, {0, 0, 9}).jump);
  EXPECT_TRUE(at(0.081, {0, 0, 9}).jump);
}

TEST_F(ThesisInterpolationTest, RandomStreamsStayFinite) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> height(0.0, 30.0);
  std::uniform_real_distribution<double> hip(-6.0, 30.0);
  int contacts = 0;
  std::uint64_t id = 0;
  for (int i = 0; i < 3000; ++i) {
    if (i % 20 == 0 && random() % 4 != 0)
      sendPlate(id, height(random), 1 + static_cast<std::uint32_t>(i / 1000));
    if (i % 20 == 0) ++id;
    const Contact contact = at(0.002 * i - 0.03, {hip(random), hip(random) - 5, hip(random)});
    if (!contact.contact) continue;
    ++contacts;
    ASSERT_TRUE(contact.displacement_mm.allFinite());
    ASSERT_GT(contact.displacement_mm.z(), 0.0);
    ASSERT_NEAR(contact.normal.norm(), 1.0, 1e-9);
    ASSERT_NE(contact.object->before, nullptr);
  }
  EXPECT_GT(contacts, 100);
}

}  // namespace
}  // namespace hapticast::client
