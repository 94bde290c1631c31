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
  EXPECT_EQ(poll(11.57), 0U);
  EXPECT_EQ(poll(11.581), 3U);
  EXPECT_EQ(filter_.dropped(), 1U);
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
