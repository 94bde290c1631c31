// SPDX-License-Identifier: MIT
#include "server/stream/stale_frame_filter.hpp"

#include <gtest/gtest.h>

namespace hapticast::server {
namespace {

constexpr double kLatency_s = 0.12;
constexpr double kInterval_s = 0.04;

/// A stream at 25 frames/s whose frames leave with a given age.
class StaleFrameFilterTest : public ::testing::Test {
 protected:
  /// Publishes the frame `id`. Returns the id of the frame that leaves; 0: none.
  std::uint64_t publish(std::uint64_t id, double now_s, double age_s) {
    EncodedFrame frame;
    frame.id = id;
    frame.media_time = mediaTime(now_s - age_s);
    const auto next =
        filter_.push(frame, mediaTime(now_s), fromSeconds(kLatency_s), fromSeconds(kInterval_s));
    return next ? next->id : 0;
  }
  std::uint64_t poll(double now_s) {
    const auto next = filter_.poll(mediaTime(now_s));
    return next ? next->id : 0;
  }

  StaleFrameFilter filter_;
};

TEST_F(StaleFrameFilterTest, PassesFramesInTime) {
  for (std::uint64_t id = 1; id <= 50; ++id) {
    const double age_s = kLatency_s + 0.2 * double(id % 2);
    EXPECT_EQ(publish(id, 10.0 + kInterval_s * double(id), age_s), id);
  }
  EXPECT_EQ(filter_.dropped(), 0U);
}

TEST_F(StaleFrameFilterTest, DropsTheBacklogOfAStall) {
  EXPECT_EQ(publish(1, 10.0, kLatency_s), 1U);
  for (const std::uint64_t id : {2, 3, 4}) {
    EXPECT_EQ(publish(id, 11.5 + 0.001 * double(id), 1.5), 0U);
    EXPECT_EQ(poll(11.5 + 0.001 * double(id)), 0U);
  }
  EXPECT_EQ(publish(5, 11.54, kLatency_s), 5U);
  EXPECT_EQ(filter_.dropped(), 3U);
  EXPECT_EQ(poll(20.0), 0U) << "nothing is left";
}

TEST_F(StaleFrameFilterTest, SendsTheLastFrameLateIfNoneFollows) {
  EXPECT_EQ(publish(1, 10.0, kLatency_s), 1U);
  EXPECT_EQ(publish(2, 11.5, 1.5), 0U);
  EXPECT_EQ(publish(3, 11.51, 1.47), 0U);
  EXPECT_EQ(poll(11.58), 0U);
  EXPECT_EQ(poll(11.591), 3U) << "two intervals after the last one";
  EXPECT_EQ(filter_.dropped(), 1U);
}

// Stops of 1 to 30 s; the line then carries a frame in 0.2 to 39 ms. Frames that are two intervals
// older than usual are old.
TEST_F(StaleFrameFilterTest, ABacklogPassesAtAnySpeed) {
  for (const double stop_s : {1.0, 3.0, 6.0, 12.0, 30.0}) {
    for (const double arrival_s : {0.0002, 0.001, 0.004, 0.02, 0.03, 0.036, 0.039}) {
      filter_ = {};
      int old = 0, fresh = 0;
      double captured_s = 0.0, free_s = 0.0;  // of the frame; when the line is free again
      const double end_s = 10.0 + stop_s + 40.0 * stop_s * arrival_s / (kInterval_s - arrival_s);
      for (std::uint64_t id = 1; captured_s < std::min(end_s, 400.0); ++id) {
        captured_s = kInterval_s * double(id);
        const bool stopped = captured_s > 10.0 && captured_s < 10.0 + stop_s;
        free_s =
            std::max({free_s + arrival_s, captured_s + kLatency_s, stopped ? 10.0 + stop_s : 0.0});
        if (filter_.poll(mediaTime(free_s))) ++old;
        if (publish(id, free_s, free_s - captured_s) == 0) continue;
        (free_s - captured_s > kLatency_s + 2.1 * kInterval_s ? old : fresh) += 1;
      }
      EXPECT_LE(old, 3) << stop_s << " s, " << arrival_s << " s a frame";
      EXPECT_GE(fresh, 240) << stop_s << " s, " << arrival_s << " s a frame";
    }
  }
}

TEST_F(StaleFrameFilterTest, AnAgeThatStaysIsTheUsualOneAfterASecond) {
  EXPECT_EQ(publish(1, 10.0, kLatency_s), 1U);
  std::uint64_t first = 0;
  for (std::uint64_t id = 2; id <= 60; ++id) {
    const double jitter_s = 0.002 * double(id * 7 % 5);
    const std::uint64_t left = publish(id, 12.0 + kInterval_s * double(id), 0.9 + jitter_s);
    if (first == 0) first = left;
    EXPECT_EQ(left, first == 0 ? 0 : id);
  }
  EXPECT_GE(first, 26U);
  EXPECT_LE(first, 40U);
}

TEST_F(StaleFrameFilterTest, KeepsTheStreamOfAServerThatIsAlwaysLate) {
  std::uint64_t left = 0;
  for (std::uint64_t id = 1; id <= 50; ++id) left += publish(id, 10.0 + 0.5 * double(id), 0.9) != 0;
  EXPECT_GE(left, 48U);
  EXPECT_EQ(publish(51, 40.0, kLatency_s), 51U) << "it recovers";
  EXPECT_EQ(publish(52, 41.0, 0.9), 0U) << "and its next stall is one again";
}

TEST_F(StaleFrameFilterTest, ForgetsTheStreamBefore) {
  EXPECT_EQ(publish(1, 10.0, 2.0), 0U);
  filter_.reset();
  EXPECT_EQ(poll(20.0), 0U);
  EXPECT_EQ(filter_.dropped(), 0U);
}

}  // namespace
}  // namespace hapticast::server
