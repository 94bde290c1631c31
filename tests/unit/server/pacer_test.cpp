// SPDX-License-Identifier: MIT
// The schedule of a clip under a virtual clock, and playing on over the clip's end.
#include "server/source/pacer.hpp"

#include <gtest/gtest.h>

#include "server/source/folder/image_sequence.hpp"
#include "server/source/synthetic/synthetic_source.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using std::chrono::milliseconds;

constexpr MediaTime kStart{milliseconds(1000)};
MediaTime at(int ms) { return kStart + milliseconds(ms); }

TEST(Pacer, FramesAreDueOnePeriodApart) {
  Pacer pacer(25.0, kStart);
  for (int i = 0; i < 10; ++i) {
    const auto plan = pacer.plan(at(i == 0 ? 0 : 40 * (i - 1) + 5));  // 5 ms of work
    EXPECT_EQ(plan.skip, 0U);
    EXPECT_EQ(plan.due, at(40 * i));
    EXPECT_EQ(pacer.frameRead(0, static_cast<std::uint64_t>(i)), at(40 * i));
  }
  EXPECT_EQ(pacer.skipped(), 0U);
}

TEST(Pacer, DoesNotDriftAtAnOddRate) {
  Pacer pacer(30.0, kStart);
  MediaTime media;
  for (std::uint64_t i = 0; i <= 30ULL * 3600ULL; ++i) {
    const auto plan = pacer.plan(media);
    ASSERT_EQ(plan.skip, 0U);
    media = pacer.frameRead(0, i);
  }
  EXPECT_EQ(media, kStart + std::chrono::hours(1));
}

TEST(Pacer, ALateFrameIsPlayedAsLongAsTheNextIsNotDue) {
  Pacer pacer(25.0, kStart);
  (void)pacer.plan(at(0));
  (void)pacer.frameRead(0, 0);
  const auto plan = pacer.plan(at(79));
  EXPECT_EQ(plan.skip, 0U);
  EXPECT_EQ(plan.due, at(40));
}

TEST(Pacer, KeepsTheNewestFrameAndCountsTheOthers) {
  Pacer pacer(25.0, kStart);
  (void)pacer.plan(at(0));
  (void)pacer.frameRead(0, 0);
  const auto plan = pacer.plan(at(80));  // exactly when frame 2 is due
  EXPECT_EQ(plan.skip, 1U);
  EXPECT_EQ(plan.due, at(80));
  EXPECT_EQ(pacer.frameRead(0, 2), at(80));
  EXPECT_EQ(pacer.plan(at(345)).skip, 5U);
  EXPECT_EQ(pacer.frameRead(0, 8), at(320));
  EXPECT_EQ(pacer.skipped(), 6U);
}

TEST(Pacer, SlowProcessingPlaysInRealTime) {
  // 100 ms of work per frame at 25 fps: every third frame or so, never falling behind.
  Pacer pacer(25.0, kStart);
  MediaTime now = kStart;
  MediaTime last;
  std::uint64_t index = 0;
  for (int i = 0; i < 50; ++i) {
    const auto plan = pacer.plan(now);
    index += plan.skip;
    now = std::max(now, plan.due);
    const MediaTime media = pacer.frameRead(0, index++);
    ASSERT_GT(media, last);
    ASSERT_LT(now - media, milliseconds(40)) << "the newest";
    last = media;
    now += milliseconds(100);
  }
  EXPECT_NEAR(static_cast<double>(pacer.skipped()), 1.5 * 50, 2);
}

TEST(Pacer, MediaTimeGoesOnOverALoopWrap) {
  Pacer pacer(25.0, kStart);
  MediaTime last;
  for (int i = 0; i < 9; ++i) {
    const auto plan = pacer.plan(at(40 * i));
    const MediaTime media =
        pacer.frameRead(static_cast<std::uint32_t>(i / 3), static_cast<std::uint64_t>(i % 3));
    EXPECT_EQ(media, plan.due);
    EXPECT_GT(media, last);
    last = media;
  }
  EXPECT_EQ(last, at(320));
}

TEST(Pacer, UnreadableFramesTakeUpTheirSlots) {
  Pacer pacer(25.0, kStart);
  (void)pacer.plan(at(0));
  EXPECT_EQ(pacer.frameRead(0, 0), at(0));
  (void)pacer.plan(at(1));
  EXPECT_EQ(pacer.frameRead(0, 3), at(120)) << "frames 1 and 2 could not be read";
  const auto plan = pacer.plan(at(41));
  EXPECT_EQ(plan.skip, 0U);
  EXPECT_EQ(plan.due, at(160));
  EXPECT_EQ(pacer.frameRead(0, 4), at(160));
  EXPECT_EQ(pacer.skipped(), 0U);
}

TEST(Pacer, ASecondPlanReplacesTheFirst) {
  Pacer pacer(25.0, kStart);
  (void)pacer.plan(at(0));
  (void)pacer.frameRead(0, 0);
  EXPECT_EQ(pacer.plan(at(5)).due, at(40));
  const auto plan = pacer.plan(at(345));  // the machine stood still
  EXPECT_EQ(plan.skip, 7U);
  EXPECT_EQ(plan.due, at(320));
  EXPECT_EQ(pacer.frameRead(0, 8), at(320));
  EXPECT_EQ(pacer.skipped(), 7U);
}

TEST(Pacer, AStallMovesTheScheduleInsteadOfSkippingThroughTheClip) {
  Pacer pacer(25.0, kStart);
  (void)pacer.plan(at(0));
  const MediaTime before = pacer.frameRead(0, 0);
  const auto plan = pacer.plan(at(3'600'000));
  EXPECT_EQ(plan.skip, 0U);
  EXPECT_EQ(plan.due, at(3'600'000));
  EXPECT_GT(pacer.frameRead(0, 1), before);
  EXPECT_EQ(pacer.plan(at(3'600'001)).due, at(3'600'040));
}

TEST(Playback, EndsWithTheClip) {
  SyntheticSource source(SceneKind::kStill, 5.0, 32, 24);  // 24 frames
  EXPECT_EQ(readSkipping(source, 22, false)->index, 22U);
  EXPECT_EQ(readSkipping(source, 0, false)->index, 23U);
  EXPECT_FALSE(readSkipping(source, 0, false));
  source.rewind();
  EXPECT_FALSE(readSkipping(source, 24, false));
}

TEST(Playback, LoopsIntoANewEpochAndNeverSkipsItsFirstFrame) {
  SyntheticSource source(SceneKind::kStill, 5.0, 32, 24);
  EXPECT_EQ(readSkipping(source, 20, true)->index, 20U);
  const auto wrapped = readSkipping(source, 5, true);
  EXPECT_EQ(wrapped->index, 0U);
  EXPECT_EQ(wrapped->epoch, 1U);
  const auto far = readSkipping(source, 48, true);
  EXPECT_EQ(far->index, 0U);
  EXPECT_EQ(far->epoch, 2U);
  EXPECT_EQ(readSkipping(source, 0, true)->index, 1U);
}

TEST(Playback, LoopingOverFramesThatHaveAllBecomeUnreadableIsAnError) {
  const SourceFolder folder;
  for (const char* name : {"1.png", "2.png", "3.png"}) {
    folder.write(std::string("rgb/") + name, cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(9)));
    folder.write(std::string("depth/") + name, cv::Mat(24, 32, CV_16UC1, cv::Scalar(700)));
  }
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(readSkipping(source, 1, true)->index, 1U);
  std::filesystem::remove_all(folder / "rgb");
  const LogLines log;
  const std::string error = errorOf([&] { (void)readSkipping(source, 3, true); });
  EXPECT_NE(error.find("rgb/1.png: cannot be read"), std::string::npos) << error;
  EXPECT_EQ(log.count(), 0) << log.text();
}

}  // namespace
}  // namespace hapticast::server
