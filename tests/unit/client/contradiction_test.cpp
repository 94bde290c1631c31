// SPDX-License-Identifier: MIT
// Two versions of one frame: by TCP and by datagrams, in either order.
#include <gtest/gtest.h>

#include <functional>

#include "client/net/frame_assembler.hpp"
#include "client/report/messages.hpp"
#include "common/protocol/fragment.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_messages.hpp"

namespace hapticast::client {
namespace {

CodedFrame makeVersion(std::uint64_t id) {
  HapticFrame frame = testing::goldenFrame();
  frame.id = id;
  frame.media_time = mediaTime(0.04 * static_cast<double>(id));
  for (HapticObject& object : frame.objects) object.changed_in_frame = id;
  return testing::coded(frame);
}

/// A datagram way and a TCP way into one assembler.
struct Ways {
  Ways() { assembler.restart(); }
  void byTcp(const CodedFrame& frame) {
    (void)assembler.add(frame, localTime(1.0));
    drain();
  }
  /// Leaves out the last `missing` parts.
  void byDatagrams(const CodedFrame& frame, std::size_t missing = 0) {
    const auto parts = packFrame(frame);
    for (std::size_t i = 0; i + missing < parts.size(); ++i) {
      const DatagramHeader header{1,
                                  frame.epoch,
                                  frame.id,
                                  frame.media_time,
                                  static_cast<std::uint16_t>(i),
                                  static_cast<std::uint16_t>(parts.size())};
      if (assembler.classify(header) == FrameAssembler::Want::kNew)
        (void)assembler.add(header, parts[i], localTime(1.0));
    }
    drain();
  }
  void drain() {
    while (assembler.next(false)) ++left;
  }
  FrameAssembler assembler;
  int left = 0;
};

/// Both orders; `other` is the second version of frame 11.
void compare(const CodedFrame& other, bool differs, std::size_t missing = 0) {
  const CodedFrame frame = makeVersion(11);
  for (const bool tcp_first : {true, false}) {
    Ways ways;
    ways.byTcp(makeVersion(10));
    if (tcp_first) {
      ways.byTcp(frame);
      ways.byDatagrams(other, missing);
    } else {
      ways.byDatagrams(other, missing);
      ways.byTcp(frame);
    }
    EXPECT_EQ(ways.assembler.contradicted(), differs) << "TCP first: " << tcp_first;
    const int left = ways.left;
    ways.byTcp(makeVersion(12));
    ways.byDatagrams(makeVersion(13));
    EXPECT_EQ(ways.left, differs ? left : left + 2);
    ways.assembler.restart();
    ways.byTcp(makeVersion(14));
    EXPECT_FALSE(ways.assembler.contradicted());
  }
}

TEST(Contradiction, TheSameFrameByBothWaysIsNone) {
  compare(makeVersion(11), false);
  CodedFrame lean = makeVersion(11);  // unchanged reliefs are left out
  for (CodedObject& object : lean.objects) object.relief = nullptr;
  compare(lean, false);
  if (packFrame(makeVersion(11)).size() > 1) compare(makeVersion(11), false, 1);
}

TEST(Contradiction, AnyDifferenceIsOne) {
  const std::function<void(CodedFrame&)> kChanges[] = {
      [](CodedFrame& frame) { frame.objects[0].motion.position_mm.z() += 0.5; },
      [](CodedFrame& frame) { frame.objects[0].motion.velocity_mm_s.x() += 1.0; },
      [](CodedFrame& frame) { frame.objects[0].impacts.clear(); },
      [](CodedFrame& frame) { frame.objects[0].material.stiffness_N_mm = 0.9; },
      [](CodedFrame& frame) { frame.objects[0].id += 100; },
      [](CodedFrame& frame) { frame.objects.pop_back(); },
      [](CodedFrame& frame) { frame.media_time += Duration(1); },
      [](CodedFrame& frame) { ++frame.epoch; },
      [](CodedFrame& frame) {
        auto relief = std::make_shared<CodedRelief>(*frame.objects[0].relief);
        relief->slices[0].back() ^= 1U;
        frame.objects[0].relief = relief;
      },
      [](CodedFrame& frame) {
        auto relief = std::make_shared<CodedRelief>(*frame.objects[0].relief);
        ++relief->rect.u;
        frame.objects[0].relief = relief;
      }};
  for (const auto& change : kChanges) {
    CodedFrame other = makeVersion(11);
    change(other);
    compare(other, true);
  }
}

TEST(Contradiction, ASecondMessageByTcpCountsAsWell) {
  Ways ways;
  ways.byTcp(makeVersion(10));
  CodedFrame other = makeVersion(10);
  other.objects[0].motion.position_mm.x() += 1.0;
  ways.byTcp(other);
  EXPECT_TRUE(ways.assembler.contradicted());
}

TEST(Contradiction, IsReportedToTheUser) {
  StreamErrorLog log;
  ReceiverCounts counts;
  counts.contradictions = 1;
  const auto line = log.onCounts(counts, localTime(1.0));
  ASSERT_TRUE(line);
  EXPECT_NE(line->find("two versions of a frame"), std::string::npos) << *line;
}

}  // namespace
}  // namespace hapticast::client
