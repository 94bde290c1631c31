// SPDX-License-Identifier: MIT
#include "client/report/connection_log.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(ConnectionTeller, SaysOnceWhatItWaitsForAndThenOnceAMinute) {
  ConnectionTeller teller("here:1");
  EXPECT_EQ(teller.lost("connection refused", localTime(0)),
            "waiting for a server at here:1 (connection refused)");
  int lines = 0;
  for (int s = 1; s <= 600; ++s) lines += teller.lost("connection refused", localTime(s)) ? 1 : 0;
  EXPECT_EQ(lines, 10) << "in ten minutes";
  EXPECT_FALSE(teller.everConnected());
  EXPECT_EQ(teller.reason(), "connection refused");
}

TEST(ConnectionTeller, SaysHowFarTheServerIsInQuarters) {
  ConnectionTeller teller("here:1");
  (void)teller.connected("connected: x", localTime(0));
  EXPECT_EQ(teller.preparing(0.1, localTime(1)),
            "the server looks through its clip first: 10 % done");
  EXPECT_FALSE(teller.preparing(0.3, localTime(2)));
  EXPECT_TRUE(teller.preparing(0.4, localTime(3)));
  (void)teller.connected("connected: x", localTime(4));
  EXPECT_TRUE(teller.preparing(0.4, localTime(5))) << "another connection";
  EXPECT_FALSE(teller.preparing(1.0, localTime(6))) << "nothing is waited for";
}

TEST(ConnectionTeller, SaysEveryNewReasonAndEveryConnection) {
  ConnectionTeller teller("here:1");
  EXPECT_TRUE(teller.lost("connection refused", localTime(0)));
  EXPECT_TRUE(teller.lost("no route", localTime(1)));
  EXPECT_EQ(teller.connected("connected: x", localTime(2)), "connected: x");
  EXPECT_TRUE(teller.everConnected());
  EXPECT_EQ(teller.reason(), "");
  EXPECT_EQ(teller.lost("the server ends", localTime(3)), "here:1: the server ends; trying again");
  EXPECT_EQ(teller.lost("connection refused", localTime(4)),
            "here:1: connection refused; trying again");
  EXPECT_FALSE(teller.lost("connection refused", localTime(5)));
  EXPECT_EQ(teller.connected("connected: x", localTime(6)), "connected: x");
}

TEST(ConnectionTeller, AServerThatComesAndGoesDoesNotFillTheLog) {
  ConnectionTeller teller("here:1");
  int lines = 0;
  std::string last;
  const auto count = [&](const std::optional<std::string>& line) {
    lines += line ? 1 : 0;
    if (line) last = *line;
  };
  for (int s = 0; s < 59; ++s) {
    count(teller.connected("connected: x", localTime(s)));
    count(teller.lost("go away " + std::to_string(s), localTime(s)));
  }
  EXPECT_EQ(lines, LineLimit::kLines);
  EXPECT_TRUE(last.ends_with(" (that is all of it for a minute)")) << last;
  EXPECT_TRUE(teller.connected("connected: x", localTime(61))) << "a minute later";
}

TEST(OddityTeller, SaysWhatIsNotShownOnceAMinute) {
  OddityTeller teller;
  ReceiverCounts counts;
  counts.duplicates = 3;
  EXPECT_FALSE(teller.take(counts, localTime(0))) << "a network may do that";
  counts.reliefs_rejected = 1;
  EXPECT_EQ(teller.take(counts, localTime(1)),
            "the server errs: reliefs outside the announced picture or too high, whose objects are "
            "not shown: 1");
  counts.reliefs_rejected = 1500;
  counts.resyncs = 2;
  EXPECT_FALSE(teller.take(counts, localTime(60)));
  EXPECT_EQ(teller.take(counts, localTime(62)),
            "the server errs: reliefs outside the announced picture or too high, whose objects are "
            "not shown: 1499; jumps of the frames' ids, after which touch begins anew: 2");
  EXPECT_FALSE(teller.take(counts, localTime(200))) << "nothing new";
}

}  // namespace
}  // namespace hapticast::client
