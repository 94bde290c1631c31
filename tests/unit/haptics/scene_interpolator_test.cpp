// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "tests/unit/haptics/scene_interpolator_fixture.hpp"

namespace hapticast::client {
namespace {

TEST_F(LookupTest, NothingBeforeTheFirstFrameIsDue) {
  EXPECT_EQ(at(0.0).kind, Lookup::kEmpty);
  sendAt(10, Vec3::Zero());
  EXPECT_EQ(at(0.399).kind, Lookup::kEmpty);
  EXPECT_EQ(at(0.399).object_count, 0U);
  EXPECT_EQ(at(0.400).kind, Lookup::kExtrapolated);
  EXPECT_EQ(lookup.lateFrames(), 0U);
}

TEST_F(LookupTest, HermiteMeetsACubicExactly) {
  const auto p = [](double t) {
    return Vec3(1 + 20 * t - 300 * t * t + 4000 * t * t * t, 5 * t, 3.0);
  };
  const auto v = [](double t) { return Vec3(20 - 600 * t + 12000 * t * t, 5.0, 0.0); };
  sendAt(0, p(0), v(0), Vec3(-600, 0, 0));
  sendAt(1, p(0.04), v(0.04), Vec3(360, 0, 0));
  for (double t = 0.0; t < 0.04; t += 0.001) {
    const Scene& scene = at(t);
    ASSERT_EQ(scene.kind, Lookup::kInterpolated);
    EXPECT_NEAR((scene.objects[0].position_mm - p(t)).norm(), 0.0, 1e-9);
    EXPECT_NEAR((scene.objects[0].velocity_mm_s - v(t)).norm(), 0.0, 1e-6);
    EXPECT_NEAR(scene.objects[0].acceleration_mm_s2.x(), -600 + 24000 * t, 1e-6);
    EXPECT_NEAR(scene.objects[0].blend, t / 0.04, 1e-6);
  }
}

// Its relief differs a little from the last one's: that must not cause a step of the force.
TEST_F(LookupTest, ALateFrameIsBlendedInFromWhereItCame) {
  sendAt(0, Vec3::Zero());
  EXPECT_EQ(at(0.010).kind, Lookup::kExtrapolated);
  sendAt(1, Vec3::Zero());
  EXPECT_NEAR(at(0.010).objects[0].blend, 0.0, 1e-6);
  EXPECT_NEAR(at(0.025).objects[0].blend, 0.5, 1e-6);
  EXPECT_NEAR(at(0.025).objects[0].blend_rate_1_s, 1.0 / 0.03, 1e-6);
  EXPECT_NEAR(at(0.0399).objects[0].blend, 1.0, 0.01);
  sendAt(2, Vec3::Zero());
  EXPECT_NEAR(at(0.05).objects[0].blend, 0.25, 1e-6);  // in time again
  (void)at(0.119);
  sendAt(3, Vec3::Zero());
  EXPECT_NEAR(at(0.119).objects[0].blend, 0.9, 1e-6);  // no faster than in a quarter
  EXPECT_NEAR(at(0.119).objects[0].blend_rate_1_s, 100.0, 1e-6);
}

TEST_F(LookupTest, LinearAndHold) {
  for (const Interpolation kind : {Interpolation::kLinear, Interpolation::kHold}) {
    pool = std::make_unique<FramePool>();
    SceneInterpolator other(*pool, kind);
    sendAt(0, Vec3(0, 0, 0), Vec3(500, 0, 0), Vec3(10, 0, 0));
    sendAt(1, Vec3(4, 0, 0), Vec3(500, 0, 0), Vec3(30, 0, 0));
    const InterpolatedObject& object = other.at(mediaTime(0.01), stream).objects[0];
    const bool hold = kind == Interpolation::kHold;
    EXPECT_NEAR(object.position_mm.x(), hold ? 0.0 : 1.0, 1e-9);
    EXPECT_NEAR(object.velocity_mm_s.x(), hold ? 0.0 : 100.0, 1e-6);
    EXPECT_NEAR(object.acceleration_mm_s2.x(), hold ? 10.0 : 15.0, 1e-6);
    EXPECT_EQ(object.after == nullptr, hold);
  }
}

TEST_F(LookupTest, TurnsTheShortWayRound) {
  PlayObject a = makeObject(1, nullptr, Vec3::Zero());
  PlayObject b = a;
  a.motion.angle_rad = 3.1;
  b.motion.angle_rad = -3.1;
  const double step = 2 * std::numbers::pi - 6.2;
  a.motion.angular_velocity_rad_s = b.motion.angular_velocity_rad_s = step / 0.04;
  send(*pool, makeFrame(1, 0, 0.0, {a}));
  send(*pool, makeFrame(1, 1, 0.04, {b}));
  EXPECT_NEAR(at(0.02).objects[0].angle_rad, 3.1 + step / 2, 1e-9);
  EXPECT_NEAR(at(0.02).objects[0].angular_velocity_rad_s, step / 0.04, 1e-6);
}

TEST_F(LookupTest, AnImpactBetweenFramesIsMetExactly) {
  // A ball falls along y, bounces at 13 ms, elastic but for a tenth: ballistic on both sides.
  const double g = -1470.0;
  const double hit = 0.013;
  const Vec3 v0(30, -400, 0);
  const Vec3 dv(0, 780, 0);
  const auto p = [&](double t) -> Vec3 {
    return Vec3(0, 6, 10) + v0 * t + 0.5 * Vec3(0, g, 0) * t * t + dv * std::max(0.0, t - hit);
  };
  for (const bool in_after : {true, false}) {
    pool = std::make_unique<FramePool>();
    SceneInterpolator other(*pool, Interpolation::kHermite);
    PlayObject a = makeObject(7, nullptr, p(0), v0, {0, g, 0});
    PlayObject b = makeObject(7, nullptr, p(0.04), v0 + dv + Vec3(0, g * 0.04, 0), {0, g, 0});
    (in_after ? b : a).impacts[0] = {mediaTime(hit), dv};
    (in_after ? b : a).impact_count = 1;
    send(*pool, makeFrame(1, 0, 0.0, {a}));
    send(*pool, makeFrame(1, 1, 0.04, {b}));
    for (double t = 0.0005; t < 0.04; t += 0.001) {
      const InterpolatedObject& object = other.at(mediaTime(t), stream).objects[0];
      EXPECT_NEAR((object.position_mm - p(t)).norm(), 0.0, 1e-5) << t;
      const Vec3 v = v0 + Vec3(0, g * t, 0) + (t >= hit ? dv : Vec3(Vec3::Zero()));
      EXPECT_NEAR((object.velocity_mm_s - v).norm(), 0.0, 1e-3) << t;
    }
  }
}

TEST_F(LookupTest, AnImpactThatExplainsNothingIsIgnored) {
  PlayObject a = makeObject(7, nullptr, {0, 0, 0}, {100, 0, 0});
  PlayObject b = makeObject(7, nullptr, {4, 0, 0}, {100, 0, 0});
  b.impacts[0] = {mediaTime(0.02), {0, 9000, 0}};
  b.impact_count = 1;
  send(*pool, makeFrame(1, 0, 0.0, {a}));
  send(*pool, makeFrame(1, 1, 0.04, {b}));
  EXPECT_NEAR((at(0.03).objects[0].position_mm - Vec3(3, 0, 0)).norm(), 0.0, 1e-9);
}

TEST_F(LookupTest, AbsurdVelocitiesBendThePathOnlyALittle) {
  sendAt(0, Vec3(0, 0, 0), Vec3(1e6, 0, 0));
  sendAt(1, Vec3(0.1, 0, 0), Vec3(-1e6, 1e9, 0));
  for (double t = 0.0; t < 0.04; t += 0.001) EXPECT_LT(at(t).objects[0].position_mm.norm(), 1.5);
}

TEST_F(LookupTest, AnAbsurdAngularVelocityBendsTheTurnOnlyALittle) {
  for (const bool later : {false, true}) {
    pool = std::make_unique<FramePool>();
    SceneInterpolator other(*pool, Interpolation::kHermite);
    PlayObject a = makeObject(1, nullptr, Vec3::Zero());
    PlayObject b = a;
    b.motion.angle_rad = 0.01;
    (later ? b : a).motion.angular_velocity_rad_s = 1e6;
    send(*pool, makeFrame(1, 0, 0.0, {a}));
    send(*pool, makeFrame(1, 1, 0.04, {b}));
    for (double t = 0.0; t < 0.04; t += 0.001)
      EXPECT_LT(std::abs(other.at(mediaTime(t), stream).objects[0].angle_rad), 0.1) << later;
  }
}

TEST_F(LookupTest, BeyondTheNewestFrameCarriedThenHeldThenFaded) {
  sendAt(0, Vec3(0, 0, 0), Vec3(100, 0, 0), Vec3(50, 0, 0));
  EXPECT_EQ(at(0.06).kind, Lookup::kExtrapolated);
  EXPECT_NEAR(at(0.06).objects[0].position_mm.x(), 6.0, 1e-9);
  EXPECT_NEAR(at(0.06).objects[0].velocity_mm_s.x(), 100.0, 1e-9);
  EXPECT_NEAR(at(0.06).objects[0].acceleration_mm_s2.x(), 12.5, 1e-6);  // ramps to 0 at 80 ms
  EXPECT_EQ(at(0.0801).kind, Lookup::kHeld);
  EXPECT_NEAR(at(0.2).objects[0].position_mm.x(), 8.0, 1e-9);
  EXPECT_EQ(at(0.2).objects[0].velocity_mm_s.x(), 0.0);
  EXPECT_EQ(at(0.2).objects[0].acceleration_mm_s2.x(), 0.0);
  EXPECT_EQ(at(0.299).kind, Lookup::kHeld);
  EXPECT_EQ(at(0.301).kind, Lookup::kStale);
  EXPECT_NEAR(at(0.301).objects[0].position_mm.x(), 8.0, 1e-9);
  stream.frame_interval = std::chrono::milliseconds(16);  // two frames are less than 80 ms
  EXPECT_EQ(at(0.031).kind, Lookup::kExtrapolated);
  EXPECT_EQ(at(0.033).kind, Lookup::kHeld);
}

TEST_F(LookupTest, NeverInterpolatesAcrossAnEpoch) {
  sendAt(0, Vec3(0, 0, 0), Vec3(100, 0, 0));
  EXPECT_TRUE(at(0.0).jumped);
  EXPECT_FALSE(at(0.005).jumped);
  EXPECT_NEAR(at(0.03).objects[0].position_mm.x(), 3.0, 1e-9);
  sendAt(1, Vec3(50, 0, 0), Vec3::Zero(), Vec3::Zero(), 2);
  EXPECT_EQ(at(0.03).kind, Lookup::kExtrapolated);  // the same whether the new epoch is here or not
  EXPECT_NEAR(at(0.03).objects[0].position_mm.x(), 3.0, 1e-9);
  EXPECT_EQ(at(0.03).objects[0].after, nullptr);
  const Scene& scene = at(0.04);
  EXPECT_TRUE(scene.jumped);
  EXPECT_EQ(scene.epoch, 2U);
  EXPECT_NEAR(scene.objects[0].position_mm.x(), 50.0, 1e-9);
  EXPECT_FALSE(at(0.041).jumped);
}

TEST_F(LookupTest, ALateFrameOfTheOldEpochComesBeforeTheNewEpoch) {
  sendAt(10, Vec3(0, 0, 0));
  (void)at(0.40);
  sendAt(11, Vec3(50, 0, 0), Vec3::Zero(), Vec3::Zero(), 2);
  EXPECT_EQ(at(0.45).epoch, 2U);
  sendAt(12, Vec3(1, 0, 0));  // of epoch 1
  sendAt(13, Vec3(50, 0, 0), Vec3::Zero(), Vec3::Zero(), 2);
  for (const double time_s : {0.47, 0.485, 0.50, 0.51}) {
    EXPECT_EQ(at(time_s).epoch, 2U) << time_s;
    EXPECT_NEAR(at(time_s).objects[0].position_mm.x(), 50.0, 1e-9) << time_s;
  }
}

TEST_F(LookupTest, ObjectsComeAndGoWithTheirFrames) {
  const PlayObject one = makeObject(1, nullptr, {0, 0, 0}, {100, 0, 0});
  const PlayObject two = makeObject(2, nullptr, {5, 0, 0});
  PlayObject layer = makeObject(1, nullptr, {0, 0, 0});
  layer.layer = 1;  // same id, another layer: another thing
  send(*pool, makeFrame(1, 0, 0.0, {one}));
  send(*pool, makeFrame(1, 1, 0.04, {two, layer}));
  send(*pool, makeFrame(1, 2, 0.08, {two, layer}));
  EXPECT_TRUE(at(0.0).objects[0].appeared);
  const Scene& scene = at(0.03);
  ASSERT_EQ(scene.object_count, 1U);
  EXPECT_EQ(scene.objects[0].before->id, 1U);
  EXPECT_EQ(scene.objects[0].after, nullptr);
  EXPECT_NEAR(scene.objects[0].position_mm.x(), 3.0, 1e-9);
  EXPECT_FALSE(scene.objects[0].appeared);
  ASSERT_EQ(at(0.05).object_count, 2U);
  SceneInterpolator again(*pool, Interpolation::kHermite);
  EXPECT_FALSE(at(0.051).objects[0].appeared);
}

TEST_F(LookupTest, AppearedHoldsForOneLookUp) {
  send(*pool, makeFrame(1, 0, 0.0, {}));
  send(*pool, makeFrame(1, 1, 0.04, {makeObject(3, nullptr, {0, 0, 0})}));
  EXPECT_EQ(at(0.01).object_count, 0U);
  EXPECT_EQ(at(0.01).kind, Lookup::kInterpolated);
  EXPECT_TRUE(at(0.041).objects[0].appeared);
  EXPECT_FALSE(at(0.042).objects[0].appeared);
}

TEST_F(LookupTest, PausedStandsStill) {
  sendAt(0, Vec3(0, 0, 0), Vec3(100, 0, 0), Vec3(9, 9, 9));
  sendAt(1, Vec3(4, 0, 0), Vec3(100, 0, 0), Vec3(9, 9, 9));
  const InterpolatedObject& object =
      lookup.at(mediaTime(0.02), stream, {.paused = true}).objects[0];
  EXPECT_NEAR(object.position_mm.x(), 2.0, 1e-9);
  EXPECT_EQ(object.velocity_mm_s.norm() + object.acceleration_mm_s2.norm(), 0.0);
  EXPECT_EQ(object.blend_rate_1_s, 0.0);
}

TEST_F(LookupTest, ANewConnectionVoidsOldFrames) {
  sendAt(0, Vec3::Zero());
  sendAt(1, Vec3::Zero());
  EXPECT_EQ(at(0.02).kind, Lookup::kInterpolated);
  stream.first_epoch = 2;
  EXPECT_EQ(at(0.021).kind, Lookup::kEmpty);
  sendAt(2, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 1);  // still on its way
  EXPECT_EQ(at(0.09).kind, Lookup::kEmpty);
  EXPECT_EQ(freeSlots(*pool, lookup, mediaTime(0.09), stream), FramePool::kSlots);
}

TEST_F(LookupTest, RejoiningVoidsEveryFrameThatIsHereAndJumpsAtTheNext) {
  sendAt(0, Vec3::Zero());
  sendAt(1, Vec3::Zero());
  EXPECT_FALSE((at(0.01), at(0.02).jumped));
  sendAt(2, Vec3::Zero());  // has arrived, but was not looked at
  lookup.resync();
  EXPECT_EQ(at(0.09).kind, Lookup::kEmpty);
  EXPECT_EQ(freeSlots(*pool, lookup, mediaTime(0.09), stream), FramePool::kSlots);
  sendAt(3, Vec3::Zero());
  EXPECT_EQ(at(0.119).kind, Lookup::kEmpty);
  EXPECT_TRUE(at(0.121).jumped);
  EXPECT_FALSE(at(0.122).jumped);
  EXPECT_EQ(lookup.lateFrames(), 0U);
}

TEST_F(LookupTest, SortsDropsDuplicatesAndCountsLateFrames) {
  for (const std::uint64_t id : {3U, 1U, 2U, 1U, 3U, 0U}) {
    sendAt(id, Vec3(static_cast<double>(id), 0, 0), Vec3(25, 0, 0));
  }
  EXPECT_NEAR(at(0.10).objects[0].position_mm.x(), 2.5, 1e-9);
  EXPECT_EQ(lookup.lateFrames(), 0U);
  sendAt(1, Vec3(1, 0, 0));  // a duplicate of a frame that is still held
  (void)at(0.10);
  EXPECT_EQ(lookup.lateFrames(), 0U);
  sendAt(5, Vec3(5, 0, 0), Vec3(25, 0, 0));
  EXPECT_NEAR(at(0.16).objects[0].position_mm.x(), 4.0, 1e-9);  // frame 4 is bridged
  sendAt(4, Vec3(4, 0, 0), Vec3(25, 0, 0));
  EXPECT_NEAR(at(0.17).objects[0].position_mm.x(), 4.25, 1e-9);
  EXPECT_EQ(lookup.lateFrames(), 1U);
}

TEST_F(LookupTest, GivesTheFourNeighboursOfOneEpoch) {
  for (std::uint64_t id = 0; id < 6; ++id) sendAt(id, Vec3::Zero());
  (void)at(0.09);
  auto around = lookup.neighbours(mediaTime(0.09));
  for (std::size_t k = 0; k < 4; ++k) {
    ASSERT_NE(around[k], nullptr);
    EXPECT_EQ(around[k]->id, k + 1);
  }
  sendAt(6, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 2);
  (void)at(0.21);
  around = lookup.neighbours(mediaTime(0.21));
  EXPECT_EQ(around[0]->id, 4U);
  EXPECT_EQ(around[1]->id, 5U);
  EXPECT_EQ(around[2], nullptr);
  EXPECT_EQ(around[3], nullptr);
  EXPECT_EQ(lookup.neighbours(mediaTime(-1.0))[1], nullptr);
}

TEST_F(LookupTest, HoldsFourFramesInSteadyPlay) {
  for (std::uint64_t id = 0; id < 200; ++id) {
    sendAt(id, Vec3::Zero());
    (void)at(static_cast<double>(id) * kInterval_s - 0.03);
  }
  // Two behind, one ahead: the rest is free.
  EXPECT_EQ(freeSlots(*pool, lookup, mediaTime(199 * kInterval_s - 0.03), stream),
            FramePool::kSlots - 4);
}

TEST_F(LookupTest, NeverStarvesTheReceiverWhenPlayTimeStalls) {
  for (std::uint64_t id = 0; id < 500; ++id) {
    sendAt(id, Vec3(static_cast<double>(id), 0, 0),
           Vec3(25, 0, 0));  // asserts that a slot was free
    (void)at(0.05);
  }
  EXPECT_EQ(at(0.05).kind, Lookup::kInterpolated);
  EXPECT_NEAR(at(0.05).objects[0].position_mm.x(), 1.25, 1e-9);
  EXPECT_EQ(lookup.neighbours(mediaTime(0.05))[3]->id, 3U);
  EXPECT_EQ(at(499 * kInterval_s).objects[0].before->motion.position_mm.x(),
            499.0);  // the newest is there
  EXPECT_GE(freeSlots(*pool, lookup, mediaTime(499 * kInterval_s), stream), FramePool::kSlots - 3);
}

TEST_F(LookupTest, FramesFarInTheFutureAreThinnedEvenly) {
  for (std::uint64_t id = 100; id < 200; ++id) {
    sendAt(id, Vec3::Zero());
    EXPECT_EQ(at(0.05).kind, Lookup::kEmpty);
  }
  double widest = 0.0;
  double last = 4.0;
  for (double t = 4.0; t < 199 * kInterval_s; t += 0.01) {
    const Scene& scene = at(t);
    ASSERT_EQ(scene.kind, Lookup::kInterpolated);
    widest = std::max(widest, 1.0 / scene.objects[0].blend_rate_1_s);
    last = t;
  }
  EXPECT_GT(last, 7.9);
  EXPECT_LE(widest, 16.5 * kInterval_s);
}

}  // namespace
}  // namespace hapticast::client
