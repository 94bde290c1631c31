// SPDX-License-Identifier: MIT
#include "client/net/frame_assembler.hpp"

#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <random>
#include <tuple>

#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"

namespace hapticast::client {
namespace {

CodedFrame frameOf(std::uint64_t id, std::uint32_t epoch = 0) {
  CodedFrame frame;
  frame.id = id;
  frame.epoch = epoch;
  frame.media_time = mediaTime(0.04 * static_cast<double>(id));
  return frame;
}

/// The frame of TCP; nullopt if it is not accepted. It leaves at once.
std::optional<AssembledFrame> whole(FrameAssembler& assembler, CodedFrame frame) {
  if (!assembler.add(std::move(frame), localTime(1.0))) return std::nullopt;
  return assembler.next(false);
}

TEST(FrameAssembler, PutsFramesInTheirPlace) {
  FrameAssembler assembler;
  assembler.restart();
  const auto first = whole(assembler, frameOf(10));
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->place.first);
  EXPECT_EQ(first->place.lost, 0U);
  const auto second = whole(assembler, frameOf(14));
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->place.first);
  EXPECT_EQ(second->place.lost, 3U);
  EXPECT_EQ(second->place.gap, mediaTime(0.56) - mediaTime(0.40));
  EXPECT_EQ(second->place.media_time, mediaTime(0.56));
  EXPECT_EQ(second->frame.id, 14U);
}

TEST(FrameAssembler, DropsDuplicatesAndLateFrames) {
  FrameAssembler assembler;
  assembler.restart();
  EXPECT_TRUE(whole(assembler, frameOf(5)));
  EXPECT_FALSE(whole(assembler, frameOf(5)));
  EXPECT_FALSE(whole(assembler, frameOf(4)));
  EXPECT_TRUE(whole(assembler, frameOf(6)));
}

TEST(FrameAssembler, OneAbsurdIdDoesNotSilenceTheStream) {
  FrameAssembler assembler;
  assembler.restart();
  const std::uint32_t begin = assembler.epoch();
  ASSERT_TRUE(whole(assembler, frameOf(81)));
  CodedFrame absurd = frameOf(82);
  absurd.id = ~std::uint64_t{0};
  const auto jumped = whole(assembler, absurd);
  ASSERT_TRUE(jumped);
  EXPECT_TRUE(jumped->place.resync);
  EXPECT_FALSE(jumped->place.first);
  EXPECT_EQ(jumped->place.lost, 0U) << "18446744073709551534 frames were never there";
  EXPECT_EQ(jumped->place.epoch, begin + 1);
  const auto back = whole(assembler, frameOf(83));
  ASSERT_TRUE(back) << "the stream goes on";
  EXPECT_TRUE(back->place.resync);
  EXPECT_EQ(back->place.epoch, begin + 2);
  EXPECT_FALSE(whole(assembler, frameOf(84))->place.resync);
}

TEST(FrameAssembler, NetworkDelaysAreNoJump) {
  FrameAssembler assembler;
  assembler.restart();
  constexpr std::uint64_t kJump = FrameAssembler::kLargestJump;
  ASSERT_TRUE(whole(assembler, frameOf(10)));
  const auto far = whole(assembler, frameOf(10 + kJump));
  EXPECT_FALSE(far->place.resync);
  EXPECT_EQ(far->place.lost, kJump - 1);
  EXPECT_FALSE(whole(assembler, frameOf(10))) << "a straggler";
  EXPECT_TRUE(whole(assembler, frameOf(9))->place.resync) << "numbers that began anew";
}

TEST(FrameAssembler, EpochsRiseWithTheServersAndWithEveryConnection) {
  FrameAssembler assembler;
  assembler.restart();
  const std::uint32_t begin = assembler.epoch();
  EXPECT_EQ(whole(assembler, frameOf(1, 7))->place.epoch, begin) << "whatever the server's is";
  EXPECT_EQ(whole(assembler, frameOf(2, 7))->place.epoch, begin);
  EXPECT_EQ(whole(assembler, frameOf(3, 8))->place.epoch, begin + 1);
  EXPECT_EQ(whole(assembler, frameOf(4, 7))->place.epoch, begin + 2)
      << "an old number, a new epoch";
  assembler.restart();
  const auto again = whole(assembler, frameOf(1, 7));
  ASSERT_TRUE(again) << "ids start over";
  EXPECT_EQ(again->place.epoch, begin + 3);
  EXPECT_TRUE(again->place.first);
}

/// Frames by datagrams: 40 ms apart from media time 0.04 s on, each of the parts that `sides`
/// needs.
class FrameAssemblerParts : public ::testing::Test {
 protected:
  FrameAssemblerParts() {
    assembler.restart();
    // The first one comes over TCP.
    EXPECT_TRUE(whole(assembler, frameOf(10)));
  }
  struct Packed {
    std::vector<DatagramHeader> headers;
    std::vector<std::vector<std::uint8_t>> payloads;
  };
  static CodedFrame codedFrame(std::uint64_t id, bool changed = true,
                               std::uint64_t changed_in = 0) {
    HapticFrame made;
    made.id = id;
    made.media_time = mediaTime(0.04 * static_cast<double>(id));
    HapticObject object;
    object.id = 1;
    object.changed_in_frame = changed ? id : changed_in;
    if (changed) object.relief = bumps(id);
    made.objects.push_back(object);
    return testing::coded(made);
  }
  static Packed packed(std::uint64_t id, bool changed = true, std::uint64_t changed_in = 0) {
    const CodedFrame made = codedFrame(id, changed, changed_in);
    Packed out{{}, packFrame(made)};
    for (std::size_t part = 0; part < out.payloads.size(); ++part)
      out.headers.push_back({7, 0, id, made.media_time, static_cast<std::uint16_t>(part),
                             static_cast<std::uint16_t>(out.payloads.size())});
    return out;
  }
  static std::shared_ptr<const Relief> bumps(std::uint64_t seed) {
    auto relief = flatRelief({0, 0, 60, 60});
    std::mt19937_64 random(seed);
    for (float& each : relief->height_mm)
      each = std::uniform_real_distribution(0.0F, 20.0F)(random);
    return relief;
  }
  bool add(const Packed& frame, std::size_t part) {
    EXPECT_EQ(assembler.classify(frame.headers[part]), FrameAssembler::Want::kNew);
    const auto added = assembler.add(frame.headers[part], frame.payloads[part], localTime(2.0));
    EXPECT_TRUE(added.ok());
    EXPECT_EQ(assembler.classify(frame.headers[part]), FrameAssembler::Want::kHad);
    return added.ok() && added.value();
  }
  void addAll(const Packed& frame, std::size_t from = 0) {
    for (std::size_t part = from; part < frame.payloads.size(); ++part)
      EXPECT_EQ(add(frame, part), part + 1 == frame.payloads.size());
  }

  FrameAssembler assembler;
};

TEST_F(FrameAssemblerParts, AFrameLeavesWhenItsLastPartHasCome) {
  const Packed frame = packed(11);
  ASSERT_GT(frame.payloads.size(), 3U);
  for (std::size_t part = frame.payloads.size(); part-- > 1;) EXPECT_FALSE(add(frame, part));
  EXPECT_FALSE(assembler.next(false));
  EXPECT_TRUE(add(frame, 0));
  const auto left = assembler.next(false);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->frame.id, 11U);
  EXPECT_EQ(left->place.gap, std::chrono::milliseconds(40));
  EXPECT_EQ(left->place.arrived, localTime(2.0));
  EXPECT_TRUE(left->frame.objects.at(0).relief->whole());
  EXPECT_FALSE(assembler.oldestCame());
}

TEST_F(FrameAssemblerParts, AFrameThatIsDueLeavesWithItsReceivedParts) {
  const Packed frame = packed(11);
  (void)add(frame, 0);
  (void)add(frame, 1);
  const auto left = assembler.next(true);
  ASSERT_TRUE(left);
  EXPECT_FALSE(left->place.arrived);
  ASSERT_TRUE(left->frame.objects.at(0).relief);
  EXPECT_FALSE(left->frame.objects[0].relief->whole());
  // What comes later is told once, and fills up a frame that says "unchanged".
  EXPECT_FALSE(assembler.takeLate());
  addAll(frame, 2);
  ASSERT_TRUE(assembler.takeLate());
  EXPECT_FALSE(assembler.takeLate());
  addAll(packed(12, false, 11));
  const auto next = assembler.next(false);
  ASSERT_TRUE(next);
  ASSERT_TRUE(next->frame.objects.at(0).relief) << "it has come in the meantime";
  EXPECT_TRUE(next->frame.objects[0].relief->whole());
}

TEST_F(FrameAssemblerParts, WithoutItsHeadAFrameIsLost) {
  const Packed frame = packed(11);
  for (std::size_t part = 1; part < frame.payloads.size(); ++part) (void)add(frame, part);
  EXPECT_FALSE(assembler.next(true)) << "its object would seem to have gone";
  addAll(packed(12));
  EXPECT_EQ(assembler.next(true)->place.lost, 1U);
}

TEST_F(FrameAssemblerParts, AnOlderFrameIsWaitedForUntilItIsDue) {
  const Packed late = packed(11);
  addAll(packed(12));
  EXPECT_FALSE(assembler.next(false)) << "11 may still come";
  addAll(late);
  EXPECT_EQ(assembler.next(false)->frame.id, 11U);
  EXPECT_EQ(assembler.next(false)->frame.id, 12U);
  addAll(packed(14));
  const auto left = assembler.next(true);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->frame.id, 14U);
  EXPECT_EQ(left->place.lost, 1U);
  addAll(packed(13));
  EXPECT_FALSE(assembler.next(true)) << "never backwards";
  EXPECT_TRUE(assembler.takeLate());
}

TEST_F(FrameAssemblerParts, FramesOverTcpTakeTheirPlaceAmongThem) {
  addAll(packed(12));
  EXPECT_TRUE(assembler.add(frameOf(11), localTime(2.0)));
  EXPECT_EQ(assembler.next(false)->frame.id, 11U);
  EXPECT_EQ(assembler.next(false)->frame.id, 12U);
  EXPECT_FALSE(assembler.add(codedFrame(12), localTime(2.0))) << "it has come by datagrams";
  EXPECT_TRUE(assembler.add(codedFrame(15), localTime(2.0)));
  EXPECT_EQ(assembler.next(false)->place.lost, 2U) << "TCP keeps its order: 13 and 14 do not come";
  // Its parts are taken all the same: they show that datagrams get through.
  addAll(packed(15));
  EXPECT_FALSE(assembler.next(true));
  EXPECT_FALSE(assembler.takeLate()) << "TCP was in time";
}

TEST_F(FrameAssemblerParts, TheFirstFrameOfAConnectionHasAllReliefs) {
  // A group's datagrams overtake the first frame over TCP. Their reliefs came before the
  // connection.
  for (const std::uint64_t tcp : {11U, 12U, 14U}) {
    assembler.restart();
    addAll(packed(12, false, 3));
    addAll(packed(13, false, 3));
    EXPECT_FALSE(assembler.next(false));
    CodedFrame key = codedFrame(tcp);
    for (CodedObject& object : key.objects) object.changed_in_frame = 3;
    ASSERT_TRUE(assembler.add(key, localTime(2.0)));
    const auto first = assembler.next(false);
    ASSERT_TRUE(first) << tcp;
    EXPECT_EQ(first->frame.id, tcp);
    EXPECT_TRUE(first->frame.objects.at(0).relief);
    EXPECT_EQ(assembler.next(false).has_value(), tcp != 14U);
  }
  assembler.restart();
  addAll(packed(20));
  EXPECT_TRUE(assembler.next(false)) << "it has all reliefs";
}

TEST_F(FrameAssemblerParts, DropsFramesFarFromTheStream) {
  constexpr auto kAstray = FrameAssembler::Want::kAstray;
  DatagramHeader header = packed(11).headers[0];
  header.frame = 10 + FrameAssembler::kLargestJump + 1;
  EXPECT_EQ(assembler.classify(header), kAstray);
  ASSERT_TRUE(whole(assembler, frameOf(200)));
  header.frame = 200 - FrameAssembler::kOldestPart - 1;
  EXPECT_EQ(assembler.classify(header), kAstray);
}

TEST_F(FrameAssemblerParts, FramesThatNeverBecomeWholeAreBounded) {
  for (std::uint64_t id = 12; id < 1000; ++id) {
    (void)add(packed(id), 1);
    while (assembler.next(false)) {
    }
  }
  std::size_t waiting = 0;
  while (assembler.oldestCame()) {
    (void)assembler.next(true);
    ASSERT_LT(++waiting, FrameAssembler::kMaxWaiting + 2);
  }
}

TEST_F(FrameAssemblerParts, AHeadThatComesLateBringsItsFrameBack) {
  const Packed frame = packed(11);
  for (std::size_t part = 1; part < frame.payloads.size(); ++part) (void)add(frame, part);
  EXPECT_FALSE(assembler.next(true)) << "passed over";
  EXPECT_TRUE(add(frame, 0));
  const auto left = assembler.next(false);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->frame.id, 11U);
  EXPECT_TRUE(left->frame.objects.at(0).relief->whole());
}

/// A hundred thousand datagrams of frames that need the most parts there can be.
enum class Ids { kRise, kRace, kBackAndForth };
class FrameAssemblerFlood : public FrameAssemblerParts,
                            public ::testing::WithParamInterface<std::tuple<Ids, bool, bool>> {};

TEST_P(FrameAssemblerFlood, KeepsFewFramesAtAnyIds) {
  const auto [ids, any_before, broken] = GetParam();
  if (!any_before) assembler.restart();
  const Packed honest = packed(11);
  const std::size_t before_bytes = mallinfo2().uordblks;
  std::size_t most_bytes = before_bytes, taken = 0;
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    DatagramHeader header = honest.headers[1];
    header.parts = 65'535;
    header.frame = ids == Ids::kRise   ? 11 + i
                   : ids == Ids::kRace ? i * FrameAssembler::kLargestJump
                                       : i / 100 * 1000 + i % 2 * 60 + i % 50;
    const std::vector<std::uint8_t> noise(9, 0xff);
    if (assembler.classify(header) != FrameAssembler::Want::kNew) continue;
    taken += assembler.add(header, broken ? noise : honest.payloads[1], localTime(2.0)).ok();
    while (assembler.next(i % 3 == 0)) {
    }
    while (assembler.takeLate()) {
    }
    most_bytes = std::max(most_bytes, mallinfo2().uordblks);
  }
  EXPECT_EQ(taken > 0, !broken);
  EXPECT_LT(most_bytes - before_bytes, 4U << 20U);
}

INSTANTIATE_TEST_SUITE_P(All, FrameAssemblerFlood,
                         ::testing::Combine(::testing::Values(Ids::kRise, Ids::kRace,
                                                              Ids::kBackAndForth),
                                            ::testing::Bool(), ::testing::Bool()));

TEST_F(FrameAssemblerParts, AnAbsurdIdByDatagramEndsWithTheNextFrameByTcp) {
  assembler.restart();
  Packed absurd = packed(11);
  for (std::size_t part = 0; part < absurd.headers.size(); ++part) {
    absurd.headers[part].frame = ~std::uint64_t{0};
    (void)assembler.add(absurd.headers[part], absurd.payloads[part], localTime(2.0));
  }
  ASSERT_TRUE(assembler.next(false));
  EXPECT_EQ(assembler.classify(packed(12).headers[0]), FrameAssembler::Want::kAstray);
  const auto back = whole(assembler, frameOf(12));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->place.resync);
  addAll(packed(13));
  EXPECT_TRUE(assembler.next(false));
}

TEST_F(FrameAssemblerParts, FrameIdsRiseWithoutRepetitionInAnyOrder) {
  std::mt19937 random(5);
  std::vector<Packed> frames;
  for (std::uint64_t id = 11; id < 60; ++id) frames.push_back(packed(id));
  std::vector<std::pair<std::size_t, std::size_t>> datagrams;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t part = 0; part < frames[i].payloads.size(); ++part) {
      for (auto copies = random() % 3; copies > 0; --copies) datagrams.emplace_back(i, part);
    }
  }
  // Each up to some 15 places away from where it was.
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < datagrams.size(); ++i)
    order.emplace_back(static_cast<double>(i) + static_cast<double>(random() % 30), i);
  std::sort(order.begin(), order.end());
  std::uint64_t last = 10;
  for (const auto& [place, i] : order) {
    const Packed& frame = frames[datagrams[i].first];
    const DatagramHeader& header = frame.headers[datagrams[i].second];
    if (assembler.classify(header) == FrameAssembler::Want::kNew) {
      ASSERT_TRUE(assembler.add(header, frame.payloads[datagrams[i].second], localTime(2)).ok());
    }
    while (const auto left = assembler.next(random() % 7 == 0)) {
      ASSERT_GT(left->frame.id, last);
      last = left->frame.id;
    }
  }
  EXPECT_GT(last, 50U);
}

}  // namespace
}  // namespace hapticast::client
