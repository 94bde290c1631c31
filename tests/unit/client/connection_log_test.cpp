// SPDX-License-Identifier: MIT
#include "client/report/messages.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(ConnectionLog, ReportsTheReasonOfItsWaitOnceAndThenOnceAMinute) {
  ConnectionLog log("here:1");
  EXPECT_EQ(log.logLoss("connection refused", localTime(0)),
            "waiting for a server at here:1 (connection refused)");
  int lines = 0;
  for (int s = 1; s <= 600; ++s) lines += log.logLoss("connection refused", localTime(s)) ? 1 : 0;
  EXPECT_EQ(lines, 10) << "in ten minutes";
  EXPECT_FALSE(log.everConnected());
  EXPECT_EQ(log.reason(), "connection refused");
}

TEST(ConnectionLog, ReportsHowFarTheServerIsInQuarters) {
  ConnectionLog log("here:1");
  (void)log.connected("connected: x", localTime(0));
  EXPECT_EQ(log.preparing(0.1, localTime(1)), "the server scans its clip first: 10 % done");
  EXPECT_FALSE(log.preparing(0.3, localTime(2)));
  EXPECT_TRUE(log.preparing(0.4, localTime(3)));
  (void)log.connected("connected: x", localTime(4));
  EXPECT_TRUE(log.preparing(0.4, localTime(5))) << "another connection";
  EXPECT_FALSE(log.preparing(1.0, localTime(6))) << "nothing is waited for";
}

TEST(ConnectionLog, ReportsEveryNewReasonAndEveryConnection) {
  ConnectionLog log("here:1");
  EXPECT_TRUE(log.logLoss("connection refused", localTime(0)));
  EXPECT_TRUE(log.logLoss("no route", localTime(1)));
  EXPECT_EQ(log.connected("connected: x", localTime(2)), "connected: x");
  EXPECT_TRUE(log.everConnected());
  EXPECT_EQ(log.reason(), "");
  EXPECT_EQ(log.logLoss("the server ends", localTime(3)), "here:1: the server ends; trying again");
  EXPECT_EQ(log.logLoss("connection refused", localTime(4)),
            "here:1: connection refused; trying again");
  EXPECT_FALSE(log.logLoss("connection refused", localTime(5)));
  EXPECT_EQ(log.connected("connected: x", localTime(6)), "connected: x");
}

TEST(ConnectionLog, AServerThatComesAndGoesDoesNotFillTheLog) {
  ConnectionLog log("here:1");
  int lines = 0;
  std::string last;
  const auto count = [&](const std::optional<std::string>& line) {
    lines += line ? 1 : 0;
    if (line) last = *line;
  };
  for (int s = 0; s < 59; ++s) {
    count(log.connected("connected: x", localTime(s)));
    count(log.logLoss("go away " + std::to_string(s), localTime(s)));
  }
  EXPECT_EQ(lines, RateLimiter::kLogBurst + 3) << "a token comes back at 15, 30 and 45 s";
  EXPECT_TRUE(last.ends_with(" lines more, not shown)")) << last;
  EXPECT_TRUE(log.connected("connected: x", localTime(61))) << "a minute later";
}

TEST(StreamErrorLog, ReportsErrorsThatAreNotShownOnceAMinute) {
  StreamErrorLog log;
  ReceiverCounts counts;
  counts.duplicates = 3;
  EXPECT_FALSE(log.onCounts(counts, localTime(0))) << "a network may do that";
  counts.reliefs_rejected = 1;
  EXPECT_EQ(log.onCounts(counts, localTime(1)),
            "server error: reliefs outside the announced picture or too high, whose objects are "
            "not shown: 1");
  counts.reliefs_rejected = 1500;
  counts.resyncs = 2;
  EXPECT_FALSE(log.onCounts(counts, localTime(60)));
  EXPECT_EQ(log.onCounts(counts, localTime(62)),
            "server error: reliefs outside the announced picture or too high, whose objects are "
            "not shown: 1499; jumps of the frame ids (each restarts the contact): 2");
  EXPECT_FALSE(log.onCounts(counts, localTime(200))) << "nothing new";
}

TEST(LateFrameLog, ReportsAStreamThatNeedsMoreDelayThanTheUserAllows) {
  LateFrameLog log(300);
  ReceiverCounts counts;
  EXPECT_FALSE(log.onCounts(counts, localTime(0)));
  counts.received = 25;
  counts.too_late = 8;
  EXPECT_FALSE(log.onCounts(counts, localTime(1))) << "a stall delays a few frames";
  counts.received = 50;
  counts.too_late = 33;
  EXPECT_FALSE(log.onCounts(counts, localTime(1.5))) << "less than a second later";
  const auto line = log.onCounts(counts, localTime(2));
  ASSERT_TRUE(line);
  EXPECT_NE(line->find("(300 ms)"), std::string::npos) << *line;
  EXPECT_NE(line->find("--max-delay"), std::string::npos) << *line;
  counts.received = 75;
  counts.too_late = 58;
  EXPECT_FALSE(log.onCounts(counts, localTime(3))) << "once a minute";
}

}  // namespace
}  // namespace hapticast::client
