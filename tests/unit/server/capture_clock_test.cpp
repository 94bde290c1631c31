// SPDX-License-Identifier: MIT
// When the frames of a network stream were captured.
#include "server/source/live/capture_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hapticast::server {
namespace {

constexpr double kStreamFrame_s = 0.04;

/// A stream of 25 frames/s whose stamps begin at 100 s. Frame 0 is captured at 1000 s.
struct Stream {
  /// The time of capture in ms after frame 0, as the clock finds it; NaN if the frame is left out.
  double captured_ms(int frame, double delay_ms, double stamp_offset_s = 100.0) {
    const double sent_s = frame * kStreamFrame_s;
    const auto captured =
        clock.capture(sent_s + stamp_offset_s, localTime(1000.0 + sent_s + 1e-3 * delay_ms));
    return captured ? 1e3 * (toSeconds(*captured) - 1000.0) : std::nan("");
  }
  CaptureClock clock;
};

TEST(CaptureClock, RemovesTheJitterOfTheNetwork) {
  Stream stream;
  EXPECT_TRUE(std::isnan(stream.captured_ms(0, 20.0))) << "the first one may have waited";
  for (int i = 1; i < 500; ++i) {
    const double jitter_ms = 7.0 * (i % 4);
    const double captured = stream.captured_ms(i, 20.0 + jitter_ms);
    EXPECT_NEAR(captured, 40.0 * i + 20.0, 0.2) << i;
    EXPECT_LE(captured, 40.0 * i + 20.0 + jitter_ms + 1e-3);
  }
}

TEST(CaptureClock, LeavesOutABurstAtTheBegin) {
  // Two seconds waited while the stream was probed; they come within half a second.
  Stream stream;
  for (int i = 0; i < 50; ++i)
    EXPECT_TRUE(std::isnan(stream.captured_ms(i, 2000.0 - 30.0 * i + 5.0))) << i;
  EXPECT_NEAR(stream.captured_ms(50, 533.0), 2533.0, 0.2);
}

TEST(CaptureClock, LeavesOutFramesThatWaitedDuringAStall) {
  Stream stream;
  for (int i = 0; i < 100; ++i) (void)stream.captured_ms(i, 10.0);
  // Frames 100 to 174 come together at the time of frame 175.
  for (int i = 100; i < 169; ++i)
    EXPECT_TRUE(std::isnan(stream.captured_ms(i, 40.0 * (175 - i) + 10.0))) << i;
  EXPECT_NEAR(stream.captured_ms(175, 10.0), 7010.0, 5.0);
  EXPECT_NEAR(stream.captured_ms(176, 10.0), 7050.0, 5.0);
}

TEST(CaptureClock, AcceptsASendersNewClock) {
  Stream stream;
  for (int i = 0; i < 100; ++i) (void)stream.captured_ms(i, 10.0);
  double left_out_s = 0.0;
  int i = 100;
  while (i < 200 && std::isnan(stream.captured_ms(i, 10.0, 90.0))) ++i;
  left_out_s = (i - 100) * kStreamFrame_s;
  EXPECT_NEAR(left_out_s, toSeconds(CaptureClock::kPatience), 2 * kStreamFrame_s);
  EXPECT_NEAR(stream.captured_ms(i + 1, 10.0, 90.0), 40.0 * (i + 1) + 10.0, 1.0);
}

TEST(CaptureClock, AFastSenderIsNoBurstForever) {
  // Stamps of 40 ms come every 10 ms.
  CaptureClock clock;
  int frames = 0;
  LocalTime last{};
  for (int i = 0; i < 1000; ++i) {
    const LocalTime arrived = localTime(10.0 + 0.01 * i);
    const auto captured = clock.capture(kStreamFrame_s * i, arrived);
    if (!captured) continue;
    ++frames;
    EXPECT_LE(*captured, arrived);
    EXPECT_GE(*captured, last);
    last = *captured;
  }
  EXPECT_GT(frames, 800);
}

TEST(CaptureClock, StampsThatAreNone) {
  CaptureClock clock;
  for (const double stamp : {HUGE_VAL, -HUGE_VAL, std::nan(""), 1e300})
    EXPECT_EQ(clock.capture(stamp, localTime(5.0)), localTime(5.0));
}

}  // namespace
}  // namespace hapticast::server
