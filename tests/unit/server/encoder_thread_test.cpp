// SPDX-License-Identifier: MIT
#include "server/pipeline/encoder_thread.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <utility>

namespace hapticast::server {
namespace {

/// The smallest sink: counts what it is given.
class CountingSink final : public StreamSink {
 public:
  void describe(const StreamDescription& description) override {
    names.push_back(description.name);
  }
  void changeKey(const DatagramKey& key) override { keys.push_back({frames.size(), key}); }
  void publish(EncodedFrame frame) override {
    if (fails_at == frame.id) throw std::runtime_error("the disk is full");
    frames.push_back(std::move(frame));
  }
  void publish(EncodedVideo video) override { videos.push_back(video.id); }
  [[nodiscard]] bool videoWanted() const override { return wants_video; }
  [[nodiscard]] bool datagramsWanted() const override { return wants_datagrams; }

  std::vector<std::string> names;
  std::vector<std::pair<std::size_t, DatagramKey>> keys;  ///< frames before each key, and the key
  std::vector<EncodedFrame> frames;
  std::vector<std::uint64_t> videos;
  bool wants_video = false;
  bool wants_datagrams = false;
  std::uint64_t fails_at = 0;
};

VisionResult result(std::uint64_t id) {
  VisionResult result{{}, cv::Mat(4, 4, CV_8UC3, cv::Scalar(0, 0, 255))};
  result.frame.id = id;
  result.frame.media_time = MediaTime(std::chrono::milliseconds(40 * id));
  return result;
}

StreamDescription named(const std::string& name) {
  StreamDescription description;
  description.name = name;
  return description;
}

TEST(EncoderThread, GivesEverySinkTheSameBytesInOrder) {
  CountingSink first, second;
  second.wants_video = true;
  EncoderThread encoder({&first, &second});
  for (std::uint64_t id = 1; id <= 20; ++id) encoder.push(named(id < 11 ? "a" : "b"), result(id));
  encoder.finish();
  ASSERT_EQ(first.frames.size(), 20U);
  ASSERT_EQ(second.frames.size(), 20U);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(first.frames[i].id, i + 1);
    EXPECT_EQ(first.frames[i].delta, second.frames[i].delta) << "encoded once";
  }
  EXPECT_EQ(first.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(second.videos.size(), 20U);
}

TEST(EncoderThread, SignsDatagramsOnlyForViewersThatRequestThem) {
  FrameSigner signer;
  for (const bool wanted : {false, true}) {
    CountingSink sink;
    sink.wants_datagrams = wanted;
    EncoderThread encoder({&sink}, &signer);
    encoder.push(named("a"), result(1));
    encoder.finish();
    ASSERT_EQ(sink.frames.size(), 1U);
    EXPECT_EQ(sink.frames[0].datagrams != nullptr, wanted);
  }
}

TEST(EncoderThread, AnnouncesAKeyBeforeTheFirstFrameUnderIt) {
  const SteadyClock clock;
  FrameSigner signer(SigningKey(), std::make_unique<DatagramSealer>(clock));
  CountingSink sink;
  sink.wants_datagrams = true;
  EncoderThread encoder({&sink}, &signer);
  encoder.push(named("a"), result(1));
  signer.revokeKey();
  encoder.push(named("a"), result(2));
  encoder.finish();
  ASSERT_EQ(sink.frames.size(), 2U);
  ASSERT_EQ(sink.keys.size(), 1U);
  constexpr std::size_t kKeyIdAt = 4;
  const auto& [frames_before, key] = sink.keys[0];
  for (std::size_t i = 0; i < 2; ++i) {
    for (const auto& body : *sink.frames[i].datagrams)
      EXPECT_EQ(body[kKeyIdAt] == key.id, i >= frames_before);
  }
}

TEST(EncoderThread, MakesPicturesOnlyForViewersThatRequestThem) {
  CountingSink sink;
  EncoderThread encoder({&sink});
  encoder.push(named("a"), result(1));
  encoder.finish();
  EXPECT_TRUE(sink.videos.empty());
}

/// Each look at it takes a millisecond.
struct TickingClock final : Clock {
  [[nodiscard]] LocalTime now() const noexcept override {
    return LocalTime(std::chrono::milliseconds(++ticks));
  }
  mutable std::atomic<int> ticks{0};
};

TEST(EncoderThread, MeasuresOnlyWithAClock) {
  const TickingClock clock;
  FrameSigner measured, plain;
  measured.measure(clock);
  for (const bool measures : {true, false}) {
    CountingSink sink;
    sink.wants_video = sink.wants_datagrams = true;
    FrameSigner& signer = measures ? measured : plain;
    EncoderThread encoder({&sink}, &signer, {}, measures ? &clock : nullptr);
    encoder.push(named("a"), result(1));
    encoder.push(named("a"), result(2));
    encoder.finish();
    EXPECT_EQ(encoder.times().encode.count, measures ? 2U : 0U);
    EXPECT_EQ(encoder.times().picture.count, measures ? 2U : 0U);
    EXPECT_EQ(encoder.times().encode.sum > Duration::zero(), measures);
    EXPECT_EQ(signer.signingTime().count > 0, measures);
    EXPECT_EQ(signer.signingTime().sum > Duration::zero(), measures);
    EXPECT_LE(signer.signingTime().sum, encoder.times().encode.sum);
  }
}

TEST(EncoderThread, PassesOnAnExceptionOfTheEncoder) {
  CountingSink sink;
  sink.fails_at = 2;
  EncoderThread encoder({&sink});
  const auto push_many = [&] {
    for (std::uint64_t id = 1; id <= 100; ++id) encoder.push(named("a"), result(id));
  };
  EXPECT_THROW(push_many(), std::runtime_error);
  EXPECT_THROW(encoder.finish(), std::runtime_error);
  EXPECT_EQ(sink.frames.size(), 1U);
}

TEST(EncoderThread, EndsByItselfWhenItIsLeft) {
  CountingSink sink;
  {
    EncoderThread encoder({&sink});
    encoder.push(named("a"), result(1));
  }
  EXPECT_EQ(sink.frames.size(), 1U);
}

}  // namespace
}  // namespace hapticast::server
