// SPDX-License-Identifier: MIT
// Warnings about frames that a source leaves out.
#include "server/source/skipped_frames.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/log_lines.hpp"

namespace hapticast::server {
namespace {

using testing::HasSubstr;

TEST(SkippedFrames, LogsEachRunOfAClipOnce) {
  SkippedFrames skipped;
  for (int playback = 0; playback < 3; ++playback) {
    const LogLines log;
    skipped.add(4, "a.png: is cut off");
    skipped.add(5, "b.png: is missing");
    skipped.endRun();
    skipped.endRun();
    EXPECT_EQ(log.count(), playback == 0 ? 1 : 0);
    if (playback == 0) {
      EXPECT_THAT(log.text(), HasSubstr("a.png: is cut off; frames 4 to 5 are left out"));
    }
  }
  const LogLines log;
  skipped.add(5, "b.png: is missing");
  skipped.add(6, "c.png: is missing");
  skipped.endRun();
  EXPECT_EQ(log.count(), 1) << "frame 6 is new";
}

TEST(SkippedFrames, LogsTheFirstRunOfALiveSourceAndEveryDoubling) {
  SkippedFrames skipped(true);
  const LogLines log;
  for (std::uint64_t i = 0; i < 100; ++i) {
    skipped.add(i, "camera: delivers a damaged picture");
    skipped.endRun();
  }
  EXPECT_EQ(log.count(), 7);
  EXPECT_THAT(log.text(), HasSubstr("the picture is left out (time 64)"));
}

TEST(SkippedFrames, ACancelledRunIsNotLogged) {
  SkippedFrames skipped;
  const LogLines log;
  EXPECT_EQ(skipped.cancelRun(), "");
  skipped.add(0, "a.png: is cut off");
  skipped.add(1, "b.png: is missing");
  EXPECT_EQ(skipped.cancelRun(), "a.png: is cut off");
  EXPECT_EQ(skipped.problem(), "");
  skipped.endRun();
  EXPECT_EQ(log.count(), 0);
}

}  // namespace
}  // namespace hapticast::server
