// SPDX-License-Identifier: MIT
#include "server/stream/encoded.hpp"

#include <gtest/gtest.h>

namespace hapticast::server {
namespace {

/// A frame every 40 ms with two objects, of which object 1 changes in every frame and object 2
/// never.
HapticFrame frame(std::uint64_t id) {
  auto relief = std::make_shared<Relief>();
  relief->rect = {0, 0, 2, 2};
  relief->height_mm.assign(4, 5.0F);
  relief->mask.assign(4, 1);
  HapticFrame frame;
  frame.id = id;
  frame.media_time = MediaTime(std::chrono::milliseconds(40 * id));
  frame.objects.resize(2);
  frame.objects[0] = {1, 0, id, relief, {}, nullptr, {}, {}};
  frame.objects[1] = {2, 0, 0, relief, {}, nullptr, {}, {}};
  return frame;
}

CodedFrame decoded(const SharedBytes& bytes) {
  auto message = decode(*bytes);
  return std::get<CodedFrame>(std::move(message).value());
}

TEST(FrameEncoder, LeavesOutUnchangedReliefs) {
  FrameEncoder encoder;
  const EncodedFrame first = encoder.encode(frame(1));
  EXPECT_EQ(first.delta, first.key_frame->payload()) << "nothing was sent before: encoded once";
  const EncodedFrame second = encoder.encode(frame(2));
  EXPECT_EQ(second.id, 2U);
  EXPECT_EQ(second.media_time, mediaTime(0.08));
  const CodedFrame lean = decoded(second.delta);
  EXPECT_TRUE(lean.objects[0].relief);
  EXPECT_FALSE(lean.objects[1].relief);
  EXPECT_EQ(second.epoch, 0U);
  const CodedFrame whole = decoded(second.key_frame->payload());
  EXPECT_TRUE(whole.objects[0].relief);
  EXPECT_TRUE(whole.objects[1].relief);
  EXPECT_EQ(second.key_frame->payload(), second.key_frame->payload()) << "once for all who ask";
}

TEST(FrameEncoder, RepeatsEveryReliefWithinASecondAndInANewEpoch) {
  FrameEncoder encoder;
  std::size_t since = 0;
  for (std::uint64_t id = 1; id <= 100; ++id) {
    const bool whole = decoded(encoder.encode(frame(id)).delta).objects[1].relief != nullptr;
    since = whole ? 0 : since + 1;
    EXPECT_LT(since, 25U) << id;
    EXPECT_EQ(whole, id % 25 == 1) << id;
  }
  HapticFrame cut = frame(101);
  EXPECT_TRUE(decoded(encoder.encode(cut).delta).objects[1].relief) << "its second is over";
  cut = frame(102);
  EXPECT_FALSE(decoded(encoder.encode(cut).delta).objects[1].relief);
  cut = frame(103);
  cut.epoch = 1;
  EXPECT_TRUE(decoded(encoder.encode(cut).delta).objects[1].relief);
}

TEST(FrameEncoder, RepeatsEveryReliefAfterAHole) {
  FrameEncoder encoder;
  for (const std::uint64_t id : {1, 2, 3}) (void)encoder.encode(frame(id));
  EXPECT_FALSE(decoded(encoder.encode(frame(8)).delta).objects[1].relief) << "after 200 ms";
  EXPECT_TRUE(decoded(encoder.encode(frame(20)).delta).objects[1].relief) << "after 480 ms";
  EXPECT_FALSE(decoded(encoder.encode(frame(21)).delta).objects[1].relief);
}

TEST(FrameEncoder, EncodesVideo) {
  const EncodedVideo video = encodeVideo({1, 2, mediaTime(3), {0xFF, 0xD8, 9}});
  const auto message = decode(*video.payload);
  EXPECT_EQ(std::get<VideoFrame>(message.value()).jpeg, (std::vector<std::uint8_t>{0xFF, 0xD8, 9}));
  EXPECT_EQ(video.id, 2U);
}

}  // namespace
}  // namespace hapticast::server
