// SPDX-License-Identifier: MIT
// The preparer by hand, and once with its thread between a network and a loop.
#include "client/net/decode_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <vector>

#include "client/net/inline_preparation.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

AssembledFrame frameOf(std::uint64_t id, std::uint64_t changed, bool with_relief) {
  AssembledFrame assembled;
  assembled.frame.id = id;
  assembled.place.epoch = 1;
  assembled.place.arrived = localTime(0.04 * static_cast<double>(id));
  assembled.place.media_time = assembled.frame.media_time =
      mediaTime(0.04 * static_cast<double>(id));
  const auto side = static_cast<int>(8 + changed % 8);
  assembled.frame.objects.push_back(testing::coded(HapticObject{
      7, 0, changed, with_relief ? flatRelief({0, 0, side, side}) : nullptr, {}, nullptr, {}, {}}));
  return assembled;
}

class FramePreparerTest : public ::testing::Test {
 protected:
  FramePreparerTest() { preparation.reset(Workspace{}); }

  /// The id of the next frame the loop gets, and what its object points to; 0 when none is there.
  std::uint64_t take() {
    FramePool::Index index = 0;
    if (!pool->pop(index)) return 0;
    field = pool->frame(index).objects[0].field;
    const std::uint64_t id = pool->frame(index).id;
    pool->release(index);
    return id;
  }

  std::unique_ptr<FramePool> pool = std::make_unique<FramePool>();
  ManualClock clock;
  std::vector<PreparedFrame> done;
  InlinePreparation preparation{*pool, clock, Method::kHapticast,
                                [this](const PreparedFrame& frame) { done.push_back(frame); }};
  const HeightField* field = nullptr;
};

TEST_F(FramePreparerTest, AFrameIsReadyWhenItsStepIsDone) {
  EXPECT_FALSE(preparation.step());
  (void)preparation.push(frameOf(1, 1, true));
  EXPECT_EQ(take(), 0U) << "pushing does not wait for the preparation";
  clock.set(localTime(3.0));
  EXPECT_TRUE(preparation.step());
  EXPECT_EQ(take(), 1U);
  EXPECT_NE(field, nullptr);
  ASSERT_EQ(done.size(), 1U);
  EXPECT_EQ(done[0].ready, localTime(3.0));
  EXPECT_EQ(done[0].place.media_time, mediaTime(0.04));
  EXPECT_TRUE(done[0].handed_over);
  EXPECT_FALSE(preparation.step());
}

TEST_F(FramePreparerTest, ADroppedReliefMayBeSentAsUnchangedLater) {
  (void)preparation.push(frameOf(1, 1, true));
  (void)preparation.push(frameOf(2, 2, true));
  std::size_t left_out = 0;
  for (std::uint64_t id = 3; id < 3 + FrameQueue::kMaxFrames; ++id) {
    left_out += preparation.push(frameOf(id, 2, false));
  }
  EXPECT_EQ(left_out, 2U);
  for (std::uint64_t id = 3; id < 3 + FrameQueue::kMaxFrames; ++id) {
    ASSERT_TRUE(preparation.step());
    EXPECT_EQ(done.back().reliefs_missing, 0U) << id;
    EXPECT_EQ(take(), id);
    ASSERT_NE(field, nullptr) << id;
    EXPECT_EQ(field->rect().width, 10);
  }
}

TEST_F(FramePreparerTest, AReliefWithoutAFreeSlotMayBeSentAsUnchangedLater) {
  for (std::uint64_t id = 1; id <= FramePool::kSlots + 1; ++id) {
    (void)preparation.push(frameOf(id, id, true));
    (void)preparation.step();
  }
  EXPECT_FALSE(done.back().handed_over);
  while (take() != 0) {
  }
  (void)preparation.push(frameOf(FramePool::kSlots + 2, FramePool::kSlots + 1, false));
  (void)preparation.step();
  EXPECT_EQ(take(), FramePool::kSlots + 2);
  EXPECT_NE(field, nullptr);
}

TEST_F(FramePreparerTest, AnotherStreamForgetsFramesAndReliefs) {
  (void)preparation.push(frameOf(1, 1, true));
  (void)preparation.step();
  (void)preparation.push(frameOf(2, 1, false));
  preparation.reset(Workspace{});
  EXPECT_FALSE(preparation.step()) << "frames that waited are void";
  (void)preparation.push(frameOf(3, 1, false));
  (void)preparation.step();
  EXPECT_EQ(done.back().reliefs_missing, 1U) << "reliefs of before are forgotten";
}

TEST_F(FramePreparerTest, LargeReliefsWaitInCodedFormUntilTheLoopReturnsASlot) {
  Workspace workspace;
  workspace.width_px = 1920;
  workspace.height_px = 1080;
  preparation.reset(workspace);
  for (std::uint64_t id = 1; id <= FramePreparer::kNeededFrames + 1; ++id) {
    HapticObject object;
    object.id = 7;
    object.changed_in_frame = id;
    object.relief = flatRelief({0, 0, 1920, 1080}, 5.0F + static_cast<float>(id));
    AssembledFrame assembled = frameOf(id, id, false);
    assembled.frame.objects[0] = testing::coded(object);
    (void)preparation.push(std::move(assembled));
    EXPECT_EQ(preparation.step(), id <= FramePreparer::kNeededFrames) << id;
  }
  EXPECT_EQ(take(), 1U);
  EXPECT_EQ(pool->occupied(), FramePreparer::kNeededFrames - 1);
  EXPECT_LT(pool->bytes(), std::size_t{80} << 20U);
  EXPECT_TRUE(preparation.step());
}

TEST_F(FramePreparerTest, SmallReliefsDoNotWait) {
  for (std::uint64_t id = 1; id <= FramePool::kSlots; ++id) {
    (void)preparation.push(frameOf(id, id, true));
    EXPECT_TRUE(preparation.step()) << id;
  }
}

TEST_F(FramePreparerTest, AReliefThatWasLostOnTheWayIsNoErrorOfTheServer) {
  const auto missing = [this](AssembledFrame assembled) {
    (void)preparation.push(std::move(assembled));
    (void)preparation.step();
    (void)take();
    return done.back().reliefs_missing;
  };
  AssembledFrame cut = frameOf(2, 2, true);  // the first frame of an epoch, without its slices
  cut.place.epoch = 2;
  cut.place.arrived.reset();
  auto relief = std::make_shared<CodedRelief>(*cut.frame.objects[0].relief);
  relief->slices.clear();
  cut.frame.objects[0].relief = std::move(relief);
  EXPECT_EQ(missing(frameOf(1, 1, true)), 0U);
  EXPECT_EQ(missing(std::move(cut)), 0U);
  EXPECT_EQ(field, nullptr);
  const auto later = [](std::uint64_t id, std::uint64_t changed, std::uint64_t lost) {
    AssembledFrame assembled = frameOf(id, changed, false);
    assembled.place.epoch = 2;
    assembled.place.lost = lost;
    return assembled;
  };
  EXPECT_EQ(missing(later(3, 2, 0)), 0U) << "of the frame that was cut";
  EXPECT_EQ(missing(later(6, 5, 2)), 0U) << "of a lost frame";
  EXPECT_EQ(missing(later(7, 7, 0)), 1U) << "of a whole frame that lacks it";
  EXPECT_EQ(missing(later(8, 5, 0)), 0U);
  EXPECT_EQ(missing(later(70, 5, 0)), 1U) << "an honest server has repeated it";
}

TEST_F(FramePreparerTest, AReliefIsPreparedOnceHoweverOftenItComes) {
  (void)preparation.push(frameOf(1, 1, true));
  (void)preparation.push(frameOf(2, 1, true));
  (void)preparation.push(frameOf(3, 1, false));
  while (preparation.step()) {
  }
  EXPECT_EQ(take(), 1U);
  const HeightField* const first = field;
  EXPECT_EQ(take(), 2U);
  EXPECT_EQ(field, first);
  EXPECT_EQ(take(), 3U);
  EXPECT_EQ(field, first);
}

TEST(DecodeThreadRuns, BringsFramesFromTheNetworkToTheLoop) {
  constexpr std::uint64_t kFrames = 500;
  const SteadyClock clock;
  const auto pool = std::make_unique<FramePool>();
  std::atomic<std::uint64_t> dropped{0};
  DecodeThread decode_thread(*pool, clock, Method::kHapticast, [&](const PreparedFrame& frame) {
    if (!frame.handed_over) ++dropped;
  });
  decode_thread.reset(Workspace{});
  decode_thread.start();
  std::jthread network([&] {
    for (std::uint64_t id = 1; id <= kFrames; ++id) {
      dropped += decode_thread.push(frameOf(id, 1 + id / 10, id % 10 == 0 || id == 1));
    }
  });
  std::uint64_t last = 0;
  std::uint64_t got = 0;
  while (got + dropped < kFrames) {
    FramePool::Index index = 0;
    if (!pool->pop(index)) {
      std::this_thread::yield();
      continue;
    }
    const PlayFrame& frame = pool->frame(index);
    EXPECT_GT(frame.id, last);
    ASSERT_NE(frame.objects[0].field, nullptr) << frame.id;
    EXPECT_EQ(frame.objects[0].field->rect().width, static_cast<int>(8 + (1 + frame.id / 10) % 8));
    last = frame.id;
    ++got;
    pool->release(index);
  }
  network.join();
  decode_thread.stop();
  EXPECT_EQ(got + dropped, kFrames);
  decode_thread.stop();  // a second time is no harm
}

}  // namespace
}  // namespace hapticast::client
