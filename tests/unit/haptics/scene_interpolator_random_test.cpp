// SPDX-License-Identifier: MIT
// Invariants of a lookup under any input: disordered streams, random frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/unit/haptics/scene_interpolator_fixture.hpp"

namespace hapticast::client {
namespace {

/// Jitter, loss and disorder: what is interpolated never steps more than the motion and its
/// corrections explain.
TEST_F(LookupTest, RandomJitteredStreamIsContinuousAndFinite) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> delay_s(0.0, 0.11);
  const double w = 2 * std::numbers::pi * 1.3;
  const auto p = [&](double t) {
    return Vec3(20 * std::sin(w * t), 15 * std::cos(0.7 * w * t), 3 * std::sin(2 * w * t));
  };
  const auto derivative = [](const auto& f, double t) -> Vec3 {
    return (f(t + 1e-4) - f(t - 1e-4)) / 2e-4;
  };
  const auto v = [&](double t) { return derivative(p, t); };
  struct Arrival {
    double time_s;
    std::uint64_t id;
  };
  std::vector<Arrival> arrivals;
  for (std::uint64_t id = 0; id < 1500; ++id) {
    if (random() % 10 != 0)
      arrivals.push_back({static_cast<double>(id) * kInterval_s + delay_s(random), id});
  }
  std::sort(arrivals.begin(), arrivals.end(), [](auto& a, auto& b) { return a.time_s < b.time_s; });
  double worst_kept = 0.0;       // step beyond v dt while the frames around stay the same
  double worst_corrected = 0.0;  // when a late frame corrects what was carried on
  std::size_t next = 0;
  Vec3 last = Vec3::Zero();
  Vec3 last_velocity = Vec3::Zero();
  Lookup last_kind = Lookup::kEmpty;
  const PlayObject* last_before = nullptr;
  const PlayObject* last_after = nullptr;
  std::size_t interpolated = 0;
  for (int tick = 200; tick < 59000; ++tick) {
    const double now = tick * 1e-3;
    for (; next < arrivals.size() && arrivals[next].time_s <= now; ++next) {
      const double t = static_cast<double>(arrivals[next].id) * kInterval_s;
      sendAt(arrivals[next].id, p(t), v(t), derivative(v, t));
    }
    const double play = now - 0.09;
    const Scene& scene = at(play);
    ASSERT_NE(scene.kind, Lookup::kEmpty);
    const InterpolatedObject& object = scene.objects[0];
    ASSERT_TRUE(object.position_mm.allFinite() && object.velocity_mm_s.allFinite());
    if (scene.kind == Lookup::kInterpolated) ++interpolated;
    const double excess =
        (object.position_mm - last - 0.5e-3 * (object.velocity_mm_s + last_velocity)).norm();
    const bool same = object.before == last_before && object.after == last_after;
    const bool advanced = last_after != nullptr && object.before == last_after;
    const bool kept = scene.kind == Lookup::kInterpolated && last_kind == Lookup::kInterpolated &&
                      (same || advanced);
    if (last_kind != Lookup::kEmpty)
      (kept ? worst_kept : worst_corrected) = std::max(kept ? worst_kept : worst_corrected, excess);
    EXPECT_LT((object.position_mm - p(play)).norm(), 12.8);
    last = object.position_mm;
    last_velocity = object.velocity_mm_s;
    last_kind = scene.kind;
    last_before = object.before;
    last_after = object.after;
  }
  EXPECT_LT(worst_kept, 0.001);
  // 1/2 a t² of 80 ms carried on at up to 2000 mm/s², and as much again while held.
  EXPECT_LT(worst_corrected, 12.8);
  EXPECT_GT(lookup.lateFrames(), 0U);
}

TEST_F(LookupTest, RandomFramesNeverBreakIt) {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> any(-1e6, 1e6);
  const auto vector = [&] { return Vec3(any(random), any(random), any(random)); };
  for (int step = 0; step < 30000; ++step) {
    PlayFrame frame;
    frame.epoch =
        1 + static_cast<std::uint32_t>(random() % 3) + static_cast<std::uint32_t>(step / 10000);
    frame.id = random() % 50;
    frame.media_time =
        random() % 50 == 0
            ? MediaTime(Duration(static_cast<std::int64_t>(random())))
            : MediaTime(Duration(static_cast<std::int64_t>(random() % 2'000'000'000)));
    frame.object_count = random() % (kMaxObjects + 1);
    for (std::size_t i = 0; i < frame.object_count; ++i) {
      frame.objects[i] = makeObject(static_cast<std::uint32_t>(random() % 4), nullptr, vector(),
                                    vector(), vector());
      frame.objects[i].motion.angle_rad = any(random);
      frame.objects[i].motion.angular_velocity_rad_s = any(random);
      frame.objects[i].impact_count = random() % (kMaxImpacts + 1);
      for (Impact& impact : frame.objects[i].impacts) {
        impact = {MediaTime(Duration(static_cast<std::int64_t>(random() % 2'000'000'000))),
                  vector()};
      }
    }
    ASSERT_TRUE(send(*pool, frame));
    stream.first_epoch = 1 + static_cast<std::uint32_t>(step / 10000);
    stream.frame_interval = Duration(static_cast<std::int64_t>(random() % 100'000'000) - 1000);
    const Scene& scene =
        lookup.at(MediaTime(Duration(static_cast<std::int64_t>(random() % 2'100'000'000))), stream);
    for (std::size_t i = 0; i < scene.object_count; ++i) {
      const InterpolatedObject& object = scene.objects[i];
      ASSERT_NE(object.before, nullptr);
      ASSERT_TRUE(object.position_mm.allFinite() && object.velocity_mm_s.allFinite() &&
                  object.acceleration_mm_s2.allFinite());
      ASSERT_TRUE(std::isfinite(object.angle_rad) && std::isfinite(object.angular_velocity_rad_s));
      ASSERT_GE(object.blend, 0.0);
      ASSERT_LE(object.blend, 1.0);
    }
  }
}

}  // namespace
}  // namespace hapticast::client
