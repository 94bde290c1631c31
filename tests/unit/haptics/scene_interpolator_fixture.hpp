// SPDX-License-Identifier: MIT
// A lookup with frames of one object on their way to it.
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "client/haptics/playback/scene_interpolator.hpp"
#include "tests/support/frame_builder.hpp"

namespace hapticast::client {

inline constexpr double kInterval_s = 0.04;

class LookupTest : public ::testing::Test {
 protected:
  const Scene& at(double time_s) { return lookup.at(mediaTime(time_s), stream); }
  void sendAt(std::uint64_t id, const Vec3& position, const Vec3& velocity = Vec3::Zero(),
              const Vec3& acceleration = Vec3::Zero(), std::uint32_t epoch = 1) {
    ASSERT_TRUE(send(*pool, makeFrame(epoch, id, static_cast<double>(id) * kInterval_s,
                                      {makeObject(7, nullptr, position, velocity, acceleration)})));
  }

  std::unique_ptr<FramePool> pool = std::make_unique<FramePool>();
  SceneInterpolator lookup{*pool, Interpolation::kHermite};
  StreamTiming stream = [] {
    StreamTiming c;
    c.connected = true;
    c.first_epoch = 1;
    return c;
  }();
};

}  // namespace hapticast::client
