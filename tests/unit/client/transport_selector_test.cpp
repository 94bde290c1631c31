// SPDX-License-Identifier: MIT
#include "client/net/udp/transport_selector.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

/// Frames at 25 Hz by the ways that work.
struct Story {
  explicit Story(std::vector<Transport> ways) : choice(std::move(ways)) {}

  void play(double seconds, bool tcp_works, bool way_works) {
    for (const double until_s = now_s + seconds; now_s < until_s; now_s += 0.04) {
      ++id;
      if (way_works && choice.transport() == working) {
        choice.probed();
        choice.onCompleteFrame(id, localTime(now_s));
      }
      if (tcp_works && order.on_tcp) choice.tcpFrame(id, localTime(now_s + 0.001));
      turn();
    }
  }
  void turn() {
    choice.update(localTime(now_s), 2, frame_interval);
    if (const auto said = choice.takeRequest()) order = *said, ++orders;
    if (const auto line = choice.nextMessage()) news.push_back(*line);
  }

  TransportSelector choice;
  Transport working = Transport::kDatagrams;
  double now_s = 100.0;
  std::uint64_t id = 0;
  Duration frame_interval = std::chrono::milliseconds(40);
  Delivery order{true, false, 1};
  int orders = 0;
  std::vector<std::string> news;
};

TEST(TransportSelector, LeavesTcpOnceDatagramsHaveComeAndReportsNothing) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.turn();
  EXPECT_EQ(story.order, (Delivery{true, true, 2})) << "both, until it works";
  story.play(2.0, true, true);
  EXPECT_EQ(story.order, (Delivery{false, true, 2}));
  EXPECT_TRUE(story.choice.works());
  EXPECT_EQ(story.orders, 2);
  EXPECT_TRUE(story.news.empty());
}

TEST(TransportSelector, AWayThatNeverWorksIsLeftAfterASecondAndTriedAgain) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.play(0.9, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kDatagrams);
  story.play(0.3, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kTcp);
  EXPECT_EQ(story.order, (Delivery{true, false, 2}));
  ASSERT_EQ(story.news.size(), 1U);
  EXPECT_NE(story.news[0].find("firewall"), std::string::npos) << story.news[0];
  story.play(29.5, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kTcp);
  story.play(1.0, true, false);
  EXPECT_EQ(story.order, (Delivery{true, true, 2})) << "tried again";
  story.play(90.0, true, false);
  EXPECT_EQ(story.news.size(), 1U) << "told once";
  story.play(40.0, true, true);
  EXPECT_EQ(story.order, (Delivery{false, true, 2}));
  ASSERT_EQ(story.news.size(), 2U);
  EXPECT_NE(story.news[1].find("again"), std::string::npos);
}

TEST(TransportSelector, ASlowStreamIsNoFailure) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.frame_interval = std::chrono::milliseconds(500);
  story.play(1.0, true, true);
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 12; ++k, story.now_s += 0.04) story.turn();
    story.play(0.04, true, true);
  }
  EXPECT_FALSE(story.order.on_tcp);
  EXPECT_EQ(story.orders, 1);
}

TEST(TransportSelector, AWayThatFailsInMidStreamIsLeftSoonAfterFourTenthsOfASecond) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.play(5.0, true, true);
  story.play(0.3, true, false);
  EXPECT_TRUE(story.choice.works());
  story.play(0.2, true, false);
  EXPECT_TRUE(story.order.on_tcp) << "0.4 s without a frame";
  story.play(0.3, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kTcp);
  EXPECT_EQ(story.news.size(), 1U);
}

TEST(TransportSelector, AStreamThatPausesIsNoFailure) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.play(5.0, true, true);
  story.play(20.0, false, false);
  // The server says again what it said last when TCP is asked for.
  story.choice.tcpFrame(story.choice.works() ? 0 : 125, localTime(story.now_s));
  story.turn();
  EXPECT_EQ(story.choice.transport(), Transport::kDatagrams);
  story.play(5.0, true, true);
  EXPECT_FALSE(story.order.on_tcp);
  EXPECT_TRUE(story.news.empty());
}

TEST(TransportSelector, APathTooNarrowForAProbeIsNotTaken) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  for (int i = 0; i < 100; ++i, story.now_s += 0.04) {
    story.choice.onCompleteFrame(static_cast<std::uint64_t>(i), localTime(story.now_s));
    story.choice.tcpFrame(static_cast<std::uint64_t>(i), localTime(story.now_s));
    story.turn();
  }
  EXPECT_TRUE(story.order.on_tcp);
  EXPECT_FALSE(story.choice.works());
  ASSERT_EQ(story.news.size(), 1U);
  EXPECT_NE(story.news[0].find("full size"), std::string::npos) << story.news[0];
}

TEST(TransportSelector, AGroupIsTakenWithItsProbe) {
  Story story({Transport::kGroup, Transport::kDatagrams, Transport::kTcp});
  story.choice.onCompleteFrame(1, localTime(story.now_s));
  story.turn();
  EXPECT_TRUE(story.order.on_tcp) << "the group's frames are small, they say nothing of its path";
  story.choice.probed();
  story.choice.onCompleteFrame(2, localTime(story.now_s));
  story.turn();
  EXPECT_FALSE(story.order.on_tcp);
}

TEST(TransportSelector, AnAbsurdIdDoesNotHideThatAWayFails) {
  Story story({Transport::kDatagrams, Transport::kTcp});
  story.play(5.0, true, true);
  story.choice.onCompleteFrame(~std::uint64_t{0}, localTime(story.now_s));
  story.play(3.0, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kTcp);
  EXPECT_EQ(story.news.size(), 1U);
}

TEST(TransportSelector, AGroupFallsBackToDatagramsAndTheseToTcp) {
  Story story({Transport::kGroup, Transport::kDatagrams, Transport::kTcp});
  story.turn();
  EXPECT_EQ(story.order, (Delivery{true, false, 2})) << "a group needs no datagrams of one's own";
  story.play(1.5, true, true);
  EXPECT_EQ(story.choice.transport(), Transport::kDatagrams);
  EXPECT_FALSE(story.order.on_tcp);
  story.play(10.0, true, true);
  story.play(2.0, true, false);
  EXPECT_EQ(story.choice.transport(), Transport::kTcp);
  EXPECT_EQ(story.news.size(), 2U);
  story.working = Transport::kGroup;
  story.play(61.0, true, true);
  EXPECT_EQ(story.choice.transport(), Transport::kGroup);
  EXPECT_TRUE(story.choice.works());
}

TEST(TransportSelector, AWayThatCannotBeOpenedIsLeftAtOnce) {
  Story story({Transport::kGroup, Transport::kDatagrams, Transport::kTcp});
  story.choice.markFailed("this machine has no network 'x'", localTime(story.now_s));
  story.turn();
  EXPECT_EQ(story.choice.transport(), Transport::kDatagrams);
  ASSERT_EQ(story.news.size(), 1U);
  EXPECT_NE(story.news[0].find("this machine has no network 'x'"), std::string::npos);
}

}  // namespace
}  // namespace hapticast::client
