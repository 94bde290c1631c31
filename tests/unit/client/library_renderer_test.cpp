// SPDX-License-Identifier: MIT
// The library's Renderer and MessagePlayer against the client under the virtual clock.
#include "client/include/hapticast/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "client/device/profile/device_profile.hpp"
#include "client/include/hapticast/stream.hpp"
#include "client/recording/replay.hpp"
#include "tests/support/drawn_stream.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kNaN = std::nan("");

/// A cylinder of 20 mm height in the middle of the picture.
Frame makeFrame(double time_s, float height_mm = 20.0F) {
  Frame frame;
  frame.time_s = time_s;
  auto heights = std::make_shared<HeightMap>(270, 190, 100, 100);
  for (int v = 0; v < 100; ++v) {
    for (int u = 0; u < 100; ++u) {
      if (std::hypot(u - 49.5, v - 49.5) < 45.0) heights->set(u, v, height_mm);
    }
  }
  frame.objects.emplace_back().heights = std::move(heights);
  return frame;
}

/// Ticks at 1 kHz with the hand at a place of the nominal frame, and frames before them.
class Touch {
 public:
  explicit Touch(const RendererSettings& settings = {}) : renderer(settings) { renderer.begin({}); }
  const Tick& step(const Eigen::Vector3d& hand_mm) {
    if (ticks_ % 40 == 0) {
      frame_.time_s = 1e-3 * ticks_;
      EXPECT_TRUE(renderer.push(frame_));
    }
    return renderer.tick(1e-3 * ticks_++ - 0.05, renderer.toDevice(hand_mm));
  }
  Renderer renderer;

 private:
  Frame frame_ = makeFrame(0.0);
  int ticks_ = 0;
};

}  // namespace

TEST(LibraryRenderer, PressesBackAtASurface) {
  Touch touch;
  double most_N = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Tick& tick = touch.step({0.0, 0.0, std::max(18.0, 40.0 - 0.05 * i)});
    most_N = std::max(most_N, tick.force_N.z());
    EXPECT_LE(tick.force_N.norm(), 3.3);
    if (tick.hip_mm.z() > 21.0) {
      EXPECT_FALSE(tick.contact);
    }
  }
  const Tick& tick = touch.step({0.0, 0.0, 18.0});
  EXPECT_TRUE(tick.contact);
  EXPECT_NEAR(tick.penetration_mm, 2.0, 0.3);
  EXPECT_GT(most_N, 0.5);
  EXPECT_EQ(tick.object_id, 1U);
  EXPECT_NEAR(tick.height_mm, 20.0, 0.1);
  EXPECT_EQ(tick.number, 1001U);
}

TEST(LibraryRenderer, FadesToZeroWithoutFramesAndWithoutMeasurements) {
  Touch touch;
  for (int i = 0; i < 1000; ++i) touch.step({0.0, 0.0, std::max(18.0, 40.0 - 0.05 * i)});
  const Eigen::Vector3d held = touch.renderer.toDevice({0.0, 0.0, 18.0});
  double before_N = touch.renderer.tick(0.951, held).force_N.norm();
  EXPECT_GT(before_N, 0.5);
  for (int i = 2; i < 1200; ++i) {
    const bool measured = i % 3 != 0;
    const double force_N =
        touch.renderer.tick(0.95 + 1e-3 * i, measured ? held : Eigen::Vector3d::Constant(kNaN))
            .force_N.norm();
    EXPECT_LT(force_N, before_N + 0.2);
    before_N = force_N;
  }
  EXPECT_EQ(before_N, 0.0);
}

TEST(LibraryRenderer, TimesThatDoNotRiseGiveNoForceOfTheirOwn) {
  Touch touch;
  for (int i = 0; i < 1000; ++i) touch.step({0.0, 0.0, std::max(18.0, 40.0 - 0.05 * i)});
  const Eigen::Vector3d held = touch.renderer.toDevice({0.0, 0.0, 18.0});
  for (const double time_s : {0.5, kNaN, kInfinity, -kInfinity, 1e300, -1e300}) {
    for (int i = 0; i < 50; ++i) {
      EXPECT_TRUE(touch.renderer.tick(time_s, held).force_N.allFinite());
    }
  }
  EXPECT_EQ(touch.renderer.tick(0.5, held).force_N.norm(), 0.0);
}

TEST(LibraryRenderer, RefusesWrongSettingsAndFrames) {
  EXPECT_THROW(Renderer({.profile = "/no/such/profile"}), std::runtime_error);
  EXPECT_THROW(Renderer({.stiffness_N_mm = -1.0}), std::invalid_argument);
  EXPECT_THROW(Renderer({.stiffness_limit_N_mm = kNaN}), std::invalid_argument);
  EXPECT_THROW(Renderer({.delay_s = 3.0}), std::invalid_argument);
  Renderer renderer;
  EXPECT_THROW((void)renderer.push(makeFrame(0.0)), std::invalid_argument);  // before begin()
  StreamInfo wrong;
  wrong.fps = 0.0;
  EXPECT_THROW(renderer.begin(wrong), std::invalid_argument);
  Renderer slow({.delay_s = 1.5});
  EXPECT_THROW(slow.begin({}), std::invalid_argument);  // 37 frames
  renderer.begin({});
  EXPECT_TRUE(renderer.push(makeFrame(1.0)));
  EXPECT_THROW((void)renderer.push(makeFrame(1.0)), std::invalid_argument);  // the same time
  EXPECT_THROW((void)renderer.push(makeFrame(kNaN)), std::invalid_argument);
  EXPECT_THROW((void)renderer.push(makeFrame(2.0, std::nanf(""))), std::invalid_argument);
  EXPECT_THROW((void)renderer.push(makeFrame(2.0, 1e6F)), std::invalid_argument);
  for (int i = 0; i < 31; ++i) EXPECT_TRUE(renderer.push(makeFrame(2.0 + i)));
  EXPECT_FALSE(renderer.push(makeFrame(40.0)));  // the pool is full
}

TEST(LibraryRenderer, PlaysOneKindOfFrames) {
  Renderer pushed;
  pushed.begin({});
  EXPECT_THROW(MessagePlayer{pushed}, std::invalid_argument);
  Renderer played;
  MessagePlayer player(played);
  EXPECT_THROW(played.begin({}), std::invalid_argument);
  EXPECT_THROW(MessagePlayer{played}, std::invalid_argument);
}

TEST(LibraryRenderer, DelayShiftsPlayTime) {
  Touch touch({.delay_s = 0.04});
  for (int i = 0; i < 500; ++i) touch.step({0.0, 0.0, 40.0});
  const Tick& tick = touch.step({0.0, 0.0, 40.0});
  EXPECT_NEAR(tick.play_time_s, tick.time_s - 0.04, 1e-6);
}

namespace {

/// A hand that presses on whatever is below it, nominal mm.
Vec3 scriptedHand(double time_s) {
  return {15.0 * std::sin(2.0 * time_s), 5.0 + 8.0 * std::sin(3.1 * time_s),
          22.0 + 8.0 * std::cos(5.0 * time_s)};
}

}  // namespace

// Required: 12 streams kept as bytes of the wire, bit-equal.
TEST(LibraryRenderer, HasTheBitsOfTheClient) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const bool thesis = seed % 4 == 0;
    client::RendererSettings settings;
    settings.profile = client::loadDeviceProfile(seed % 3 == 0 ? "falcon" : "omni");
    settings.method = thesis ? Method::kThesis : Method::kHapticast;
    client::VirtualViewer viewer(settings, client::loadDeviceProfile("omni"), client::Hand{},
                                 nullptr);
    Renderer renderer({.profile = seed % 3 == 0 ? "falcon" : "omni", .thesis = thesis});
    MessagePlayer player(renderer);
    const auto messages = testing::DrawnStream(seed).draw(localTime(1.0), 4.0);
    const auto device = DeviceMapping::fit(Workspace{}, settings.profile.workspace_mm);
    client::TickReport theirs;
    std::size_t next = 0;
    int contacts = 0;
    for (int i = 1; i <= 4000; ++i) {
      const LocalTime now = localTime(1.0) + i * kTickPeriod;
      for (; next < messages.size() && messages[next].arrival < now; ++next) {
        viewer.moveTo(messages[next].arrival);
        EXPECT_TRUE(viewer.receive(messages[next].bytes));
        player.push(messages[next].bytes, toSeconds(messages[next].arrival));
      }
      viewer.moveTo(now - kTickPeriod);
      const Vec3 hand_mm = device.toNominal(testing::chooseHand(theirs, 1e-3 * i));
      viewer.nail(hand_mm);
      theirs = viewer.tick();
      player.release(toSeconds(now));
      const Tick& ours = renderer.tick(toSeconds(now), device.toDevice(hand_mm));
      ASSERT_TRUE(client::hasSameBits(theirs.force_N, ours.force_N))
          << "seed " << seed << ", tick " << i;
      ASSERT_TRUE(client::hasSameBits(theirs.dynamic_force_N, ours.dynamic_force_N));
      ASSERT_EQ(theirs.safety_actions, ours.safety_actions);
      contacts += ours.contact ? 1 : 0;
    }
    EXPECT_GT(contacts, 100) << "seed " << seed << " touches nothing";
  }
}

TEST(LibraryRendererMessages, DamagedMessagesAreErrorsAndTheForceFades) {
  std::mt19937 random(7);
  Renderer renderer;
  MessagePlayer player(renderer);
  const auto messages = testing::DrawnStream(5).draw(localTime(1.0), 2.0);
  std::size_t next = 0;
  int errors = 0;
  double last_N = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    const LocalTime now = localTime(1.0) + i * kTickPeriod;
    for (; next < messages.size() && messages[next].arrival < now; ++next) {
      auto bytes = messages[next].bytes;
      if (random() % 20 == 0)
        bytes[random() % bytes.size()] += static_cast<std::uint8_t>(1 + random() % 255);
      try {
        player.push(bytes, toSeconds(messages[next].arrival));
      } catch (const std::runtime_error& error) {
        ++errors;
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
    player.release(toSeconds(now));
    const Tick& tick = renderer.tick(toSeconds(now), scriptedHand(1e-3 * i));
    ASSERT_TRUE(tick.force_N.allFinite());
    EXPECT_LE(tick.force_N.norm(), last_N + 0.21);
    last_N = tick.force_N.norm();
  }
  EXPECT_GT(errors, 0);
  EXPECT_THROW(player.push({}, 4.0), std::runtime_error);
  EXPECT_THROW(player.push({}, kNaN), std::invalid_argument);
}

}  // namespace hapticast
