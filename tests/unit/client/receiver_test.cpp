// SPDX-License-Identifier: MIT
// The receiver under virtual time: the test is server, network and loop.
#include "client/net/receiver.hpp"
#include "client/net/inline_preparation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "common/protocol/fragment.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::client {
namespace {

constexpr double kOffset_s = 500.0;  // media clock - local clock
constexpr double kLatency_s = 0.1;   // pipeline

class ReceiverTest : public ::testing::Test {
 protected:
  ReceiverTest() {
    description.pipeline_latency = fromSeconds(kLatency_s);
    description.workspace.width_px = 320;
    description.workspace.height_px = 240;
  }

  void syncClock(double now_s) {
    for (std::size_t i = 0; i < ClockSync::kNeeded; ++i) {
      receiver.pong({localTime(now_s - 0.002), mediaTime(now_s - 0.001 + kOffset_s),
                     mediaTime(now_s - 0.001 + kOffset_s)},
                    localTime(now_s));
    }
  }
  HapticFrame frame(std::uint64_t id, std::shared_ptr<const Relief> with = nullptr,
                    std::uint64_t changed = 1) const {
    HapticFrame frame;
    frame.id = id;
    frame.media_time = mediaTime(0.04 * static_cast<double>(id) + kOffset_s);
    frame.objects.push_back({7, 0, changed, std::move(with), {}, nullptr, {}, {}});
    return frame;
  }
  /// Arrives `lateness_s` after it was complete.
  void arrive(const HapticFrame& frame, double lateness_s = 0.010) {
    clock.set(LocalTime((frame.media_time.time_since_epoch() - fromSeconds(kOffset_s)) +
                        fromSeconds(kLatency_s + lateness_s)));
    receiver.frame(testing::coded(frame), clock.now());
    (void)preparation.step();
  }
  /// What the loop gets next; null when nothing came.
  const PlayFrame* take() {
    FramePool::Index index = 0;
    if (!pool->pop(index)) return nullptr;
    taken.push_back(index);
    return &pool->frame(index);
  }
  void giveBack() {
    for (const auto index : taken) pool->release(index);
    taken.clear();
  }

  std::unique_ptr<FramePool> pool = std::make_unique<FramePool>();
  LatestValue<StreamTiming> stream;
  ManualClock clock;
  InlinePreparation preparation{
      *pool, clock, Method::kHapticast,
      [this](const PreparedFrame& frame) { receiver.addPrepared(frame); }};
  Receiver receiver{preparation, stream, 1};
  StreamDescription description;
  std::vector<FramePool::Index> taken;
};

TEST_F(ReceiverTest, IsConnectedOnceStreamAndClockAreKnown) {
  description.mass_kg = 0.5;
  description.largest_acceleration_mm_s2 = 100.0;
  description.fps = 50.0;
  EXPECT_FALSE(stream.load().connected);
  receiver.connected(description, localTime(1));
  EXPECT_FALSE(stream.load().connected);
  syncClock(1.1);
  const StreamTiming now = stream.load();
  EXPECT_TRUE(now.connected);
  EXPECT_EQ(now.clock_offset, fromSeconds(kOffset_s));
  EXPECT_EQ(now.pipeline_latency, fromSeconds(kLatency_s));
  EXPECT_EQ(now.frame_interval, std::chrono::milliseconds(20));
  EXPECT_EQ(now.workspace, description.workspace);
  EXPECT_EQ(now.author_mass_kg, 0.5);
  EXPECT_EQ(now.largest_acceleration_mm_s2, 100.0);
  receiver.disconnected(localTime(2));
  EXPECT_FALSE(stream.load().connected);
}

TEST_F(ReceiverTest, HandsFramesToTheLoop) {
  receiver.connected(description, localTime(1));
  HapticFrame sent = frame(1, flatRelief({10, 20, 40, 30}));
  sent.objects[0].layer = 2;
  sent.objects[0].motion.velocity_mm_s = {1, 2, 3};
  sent.objects[0].impacts = {{mediaTime(9), {0, 1, 0}}};
  sent.objects[0].material.stiffness_N_mm = 0.25;
  arrive(sent);
  const PlayFrame* const got = take();
  ASSERT_NE(got, nullptr);
  EXPECT_EQ(got->id, 1U);
  EXPECT_EQ(got->media_time, sent.media_time);
  EXPECT_EQ(got->epoch, stream.load().first_epoch);
  ASSERT_EQ(got->object_count, 1U);
  const PlayObject& object = got->objects[0];
  EXPECT_EQ(object.id, 7U);
  EXPECT_EQ(object.layer, 2U);
  EXPECT_EQ(object.motion.velocity_mm_s, Vec3(1, 2, 3));
  ASSERT_EQ(object.impact_count, 1U);
  EXPECT_EQ(object.impacts[0].time, mediaTime(9));
  EXPECT_EQ(object.material.stiffness_N_mm, 0.25);
  ASSERT_NE(object.field, nullptr);
  EXPECT_EQ(object.field->rect(), (PixelRect{10, 20, 40, 30}));
  EXPECT_TRUE(object.field->inside({30.0, 35.0}));
  EXPECT_EQ(take(), nullptr);
}

TEST_F(ReceiverTest, AMotionOfQualityZeroIsNone) {
  receiver.connected(description, localTime(1));
  HapticFrame sent = frame(1, flatRelief({10, 20, 40, 30}));
  sent.objects[0].motion.position_mm = {4, 5, 6};
  sent.objects[0].motion.velocity_mm_s = {1, 2, 3};
  sent.objects[0].motion.acceleration_mm_s2 = {1, 2, 3};
  sent.objects[0].motion.angular_velocity_rad_s = 1.0;
  sent.objects[0].motion.quality = 0.0;
  sent.objects[0].impacts = {{mediaTime(9), {0, 1, 0}}};
  arrive(sent);
  const PlayFrame* const got = take();
  ASSERT_NE(got, nullptr);
  const PlayObject& object = got->objects[0];
  EXPECT_NE(object.field, nullptr) << "its shape is still there";
  EXPECT_EQ(object.motion.position_mm, Vec3(4, 5, 6));
  EXPECT_EQ(object.motion.velocity_mm_s, Vec3::Zero());
  EXPECT_EQ(object.motion.acceleration_mm_s2, Vec3::Zero());
  EXPECT_EQ(object.motion.angular_velocity_rad_s, 0.0);
  EXPECT_EQ(object.impact_count, 0U);
}

TEST_F(ReceiverTest, UnchangedReliefsShareTheFieldPreparedBefore) {
  receiver.connected(description, localTime(1));
  arrive(frame(1, flatRelief({0, 0, 40, 30})));
  arrive(frame(2));
  arrive(frame(3, flatRelief({0, 0, 40, 30})));     // repeated for who joined
  arrive(frame(4, flatRelief({0, 0, 20, 20}), 4));  // changed
  arrive(frame(5, nullptr, 4));
  const HeightField* const first = take()->objects[0].field;
  EXPECT_EQ(take()->objects[0].field, first);
  EXPECT_EQ(take()->objects[0].field, first);
  const HeightField* const second = take()->objects[0].field;
  EXPECT_NE(second, first);
  EXPECT_EQ(take()->objects[0].field, second);
}

TEST_F(ReceiverTest, AnUnchangedReliefThatNeverCameIsTheOneBeforeOrAnObjectWithoutField) {
  receiver.connected(description, localTime(1));
  arrive(frame(1));
  arrive(frame(2, flatRelief({0, 0, 8, 8})));
  arrive(frame(4, nullptr, 3));  // changed in a frame that was lost
  HapticFrame other = frame(6, nullptr, 5);
  ++other.epoch;
  arrive(other);
  EXPECT_EQ(take()->objects[0].field, nullptr);
  EXPECT_NE(take()->objects[0].field, nullptr);
  EXPECT_NE(take()->objects[0].field, nullptr) << "what was there goes on";
  EXPECT_EQ(take()->objects[0].field, nullptr) << "but not in another epoch";
  EXPECT_EQ(receiver.counts().reliefs_missing, 1U) << "the second may have come in frame 5";
}

TEST_F(ReceiverTest, RejectsReliefsOutsideTheAnnouncedPicture) {
  receiver.connected(description, localTime(1));
  arrive(frame(1, flatRelief({300, 0, 21, 8})));
  arrive(frame(2, flatRelief({0, 0, 8, 8}, 40.0F), 2));  // higher than the workspace
  arrive(frame(3, flatRelief({300, 232, 20, 8}), 3));
  EXPECT_EQ(take()->objects[0].field, nullptr);
  EXPECT_EQ(take()->objects[0].field, nullptr);
  EXPECT_NE(take()->objects[0].field, nullptr);
  EXPECT_EQ(receiver.counts().reliefs_rejected, 2U);
}

TEST_F(ReceiverTest, CarriesGridsThatCoverTheirRelief) {
  receiver.connected(description, localTime(1));
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = 3;  // 40 px in cells of 16
  grid->rows = 2;     // 30 px
  grid->velocity_mm_s.resize(6, Eigen::Vector3f::UnitX());
  grid->acceleration_mm_s2.resize(6, Eigen::Vector3f::Zero());
  HapticFrame good = frame(1, flatRelief({0, 0, 40, 30}));
  good.objects[0].grid = grid;
  arrive(good);
  HapticFrame lean = frame(2);
  lean.objects[0].grid = grid;
  arrive(lean);
  HapticFrame other = frame(3, flatRelief({0, 0, 60, 30}), 3);
  other.objects[0].grid = grid;
  arrive(other);
  EXPECT_EQ(take()->objects[0].grid, grid.get());
  const PlayFrame* const second = take();
  EXPECT_EQ(second->objects[0].grid, grid.get());
  EXPECT_EQ(second->objects[0].grid_rect, (PixelRect{0, 0, 40, 30}));
  EXPECT_EQ(take()->objects[0].grid, nullptr) << "of another size";
}

TEST_F(ReceiverTest, AFrameWaitsForItsPartsAQuarterOfAnIntervalBeyondItsTime) {
  receiver.connected(description, localTime(1));
  syncClock(1.1);
  arrive(frame(1, flatRelief({0, 0, 300, 200})));
  const CodedFrame second = testing::coded(frame(2, flatRelief({0, 0, 300, 200}, 6.0F), 2));
  const auto parts = packFrame(second);
  ASSERT_EQ(parts.size(), 1U) << "a flat relief is small";
  const auto due = [&] { return receiver.nextDue(); };
  EXPECT_FALSE(due()) << "nothing waits";
  // Of two parts, one never comes.
  const DatagramHeader header{1, second.epoch, second.id, second.media_time, 0, 2};
  EXPECT_FALSE(receiver.part(header, parts[0], clock.now()));
  ASSERT_TRUE(due());
  // Play time reaches frame 1 when the playout delay has passed since it was complete.
  const LocalTime played = LocalTime(frame(1).media_time.time_since_epoch()) -
                           fromSeconds(kOffset_s) + fromSeconds(kLatency_s) +
                           stream.load().playout_delay_target;
  EXPECT_NEAR(toSeconds(*due() - played), 0.010, 1e-6);
  receiver.release(*due() - Duration(1));
  EXPECT_FALSE(preparation.step());
  receiver.release(*due());
  EXPECT_TRUE(preparation.step());
  EXPECT_FALSE(due());
}

TEST_F(ReceiverTest, PlayTimeWaitsForTheLastCopy) {
  receiver.connected(description, localTime(1));
  syncClock(1.1);
  const Duration alone = stream.load().playout_delay_target;
  receiver.expectCopies(3, localTime(1.2));
  EXPECT_EQ(stream.load().playout_delay_target, alone + 2 * stream.load().frame_interval);
}

TEST_F(ReceiverTest, DropsDuplicatesAndCountsLosses) {
  receiver.connected(description, localTime(1));
  for (const std::uint64_t id : {10U, 11U, 11U, 14U, 13U, 15U}) arrive(frame(id));
  EXPECT_EQ(receiver.counts().received, 4U);
  EXPECT_EQ(receiver.counts().duplicates, 2U);
  EXPECT_EQ(receiver.counts().lost, 2U);
  for (const std::uint64_t id : {10U, 11U, 14U, 15U}) EXPECT_EQ(take()->id, id);
}

TEST_F(ReceiverTest, ANumberingThatBeginsAnewIsAnotherStream) {
  receiver.connected(description, localTime(1));
  arrive(frame(10'000, flatRelief({0, 0, 8, 8}), 3));
  arrive(frame(5, nullptr, 3));
  arrive(frame(6, flatRelief({0, 0, 8, 8}), 3));
  EXPECT_EQ(receiver.counts().resyncs, 1U);
  EXPECT_EQ(receiver.counts().received, 3U);
  EXPECT_EQ(receiver.counts().lost, 0U);
  EXPECT_NE(take()->objects[0].field, nullptr);
  const PlayFrame* const anew = take();
  EXPECT_EQ(anew->epoch, stream.load().first_epoch + 1);
  EXPECT_EQ(anew->objects[0].field, nullptr) << "frame 3 was another one";
  EXPECT_NE(take()->objects[0].field, nullptr) << "until it is repeated";
}

TEST_F(ReceiverTest, ANewNumberingGetsNoReliefThatWaitedInTheQueue) {
  receiver.connected(description, localTime(1));
  receiver.frame(testing::coded(frame(10'000, flatRelief({0, 0, 8, 8}), 3)), localTime(2));
  // They push the first frame out of the queue, which keeps its relief.
  for (std::uint64_t id = 5; id <= 5 + FrameQueue::kMaxFrames; ++id)
    receiver.frame(testing::coded(frame(id, nullptr, 3)), localTime(2));
  while (preparation.step()) {
  }
  int count = 0;
  while (const PlayFrame* const got = take()) {
    ++count;
    EXPECT_EQ(got->objects[0].field, nullptr) << "frame 3 was another one";
  }
  EXPECT_GT(count, 10);
}

TEST_F(ReceiverTest, EpochsNeverRepeat) {
  receiver.connected(description, localTime(1));
  HapticFrame cut = frame(2);
  cut.epoch = 5;
  arrive(frame(1));
  arrive(cut);
  const std::uint32_t first = take()->epoch;
  EXPECT_EQ(first, stream.load().first_epoch);
  EXPECT_EQ(take()->epoch, first + 1);
  receiver.connected(description, localTime(2));  // the server is back and starts at id 1 again
  arrive(frame(1));
  EXPECT_EQ(stream.load().first_epoch, first + 2);
  const PlayFrame* const got = take();
  EXPECT_EQ(got->epoch, first + 2);
  EXPECT_EQ(got->objects[0].field, nullptr) << "reliefs of the connection before are void";
}

TEST_F(ReceiverTest, CountsFramesThatDoNotFitThePoolAndGoesOn) {
  receiver.connected(description, localTime(1));
  for (std::uint64_t id = 1; id <= FramePool::kSlots; ++id) arrive(frame(id));
  arrive(frame(FramePool::kSlots + 1, flatRelief({0, 0, 8, 8}), FramePool::kSlots + 1));
  EXPECT_EQ(receiver.counts().no_slot, 1U);
  while (take() != nullptr) {
  }
  giveBack();
  arrive(frame(FramePool::kSlots + 2, nullptr, FramePool::kSlots + 1));
  const PlayFrame* const got = take();
  ASSERT_NE(got, nullptr);
  EXPECT_NE(got->objects[0].field, nullptr) << "the relief of the dropped frame is known";
}

TEST_F(ReceiverTest, TheErrorOfTheServersClockCountsUntilItsNextPong) {
  receiver.connected(description, localTime(1));
  syncClock(1.1);
  const auto answer = [this](double now_s, Duration error) {
    const MediaTime there = mediaTime(now_s - 0.001 + kOffset_s);
    receiver.pong({localTime(now_s - 0.002), there, there, error}, localTime(now_s));
  };
  answer(1.2, fromSeconds(0.003));
  EXPECT_EQ(receiver.clockErrorBound(), fromSeconds(0.004)) << "half the round trip is 1 ms";
  answer(1.3, fromSeconds(0.0005));
  EXPECT_EQ(receiver.clockErrorBound(), fromSeconds(0.0015));
  answer(1.4, fromSeconds(0.003));
  receiver.connected(description, localTime(2));
  syncClock(2.1);
  EXPECT_EQ(receiver.clockErrorBound(), fromSeconds(0.001));
}

TEST_F(ReceiverTest, AsksForAPlayoutDelayThatCoversTheJitter) {
  receiver.connected(description, localTime(0));
  syncClock(0.1);
  EXPECT_EQ(stream.load().playout_delay_target, fromSeconds(0.040) + JitterEstimator::kMargin);
  arrive(frame(1), 3.0);  // the frame a viewer is sent on joining may be old
  for (std::uint64_t id = 2; id <= 200; ++id) arrive(frame(id), id % 10 == 0 ? 0.060 : 0.010);
  // One frame in ten comes 60 ms late: the 0.99 quantile has to cover it.
  EXPECT_NEAR(toSeconds(stream.load().playout_delay_target), 0.060 + 0.005 + 0.040, 1e-4);
  const auto late = receiver.counts().late;
  EXPECT_GT(late, 0U) << "the first of them came unexpected";
  EXPECT_LE(late, 3U) << "one late frame alone decides nothing";
  arrive(frame(201), 0.200);
  EXPECT_EQ(receiver.counts().late, late + 1);
  EXPECT_EQ(receiver.clockErrorBound(), std::chrono::milliseconds(1));
}

/// A server at 25 frames/s that stands still. Its vision holds the last frames before the stop.
TEST_F(ReceiverTest, OneStallOfTheServerDoesNotRaiseTheDelay) {
  constexpr std::uint64_t kBefore = 130;
  constexpr std::uint64_t kHeld = 4;
  for (const double stall_s : {0.3, 0.8, 1.5, 3.0}) {
    receiver.connected(description, localTime(0));
    syncClock(0.0);
    for (std::uint64_t id = 1; id <= kBefore; ++id) arrive(frame(id));
    const Duration before = stream.load().playout_delay_target;
    for (std::uint64_t i = 1; i <= kHeld; ++i)
      arrive(frame(kBefore + i), stall_s - 0.040 * double(i - 1));
    const auto next = kBefore + std::uint64_t(std::ceil(stall_s / 0.04)) + kHeld;
    for (std::uint64_t i = 0; i < 3; ++i) {
      arrive(frame(next + i));
      EXPECT_LE(stream.load().playout_delay_target - before, std::chrono::milliseconds(1))
          << stall_s;
    }
    while (take() != nullptr) giveBack();
  }
}

TEST_F(ReceiverTest, CountsFramesThatTheLargestDelayDoesNotCover) {
  receiver.connected(description, localTime(0));
  syncClock(0.0);
  arrive(frame(1));
  arrive(frame(2), 1.9);
  EXPECT_EQ(receiver.counts().too_late, 0U);
  arrive(frame(3), 2.1);
  EXPECT_EQ(receiver.counts().too_late, 1U);
}

}  // namespace
}  // namespace hapticast::client
