// SPDX-License-Identifier: MIT
// Recordings of a stream: what the recorder writes plays byte-equal; after seeks, loops and other
// speeds it is still a stream whose frames count up.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>

#include "common/playback/recording_player.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"
#include "common/wire_limits.hpp"
#include "server/recording/stream_recorder.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast::server {
namespace {

constexpr int kFrames = 200;
constexpr Duration kPeriod = std::chrono::milliseconds(40);

StreamDescription describe() {
  StreamDescription description;
  description.name = "two bodies";
  description.workspace.width_px = 64;
  description.workspace.height_px = 48;
  return description;
}

/// Object 1 changes in every frame, object 2 in every thirtieth.
HapticFrame makeFrame(std::uint64_t id) {
  HapticFrame frame;
  frame.epoch = id < 120 ? 3 : 4;
  frame.id = id;
  frame.media_time = mediaTime(12.0) + static_cast<std::int64_t>(id) * kPeriod;
  for (const std::uint32_t object : {1U, 2U}) {
    const std::uint64_t changed = object == 1 ? id : id - id % 30;
    auto relief = std::make_shared<Relief>(Relief::blank({0, 0, 8, 8}));
    relief->mask.assign(64, 1);
    relief->height_mm.assign(64, static_cast<float>(1.0 + 0.05 * static_cast<double>(changed)));
    HapticObject& to = frame.objects.emplace_back();
    to.id = object;
    to.changed_in_frame = changed;
    to.relief = std::move(relief);
    to.motion.velocity_mm_s = {10.0, 0.0, -20.0};
    to.motion.acceleration_mm_s2 = {0.0, 100.0, 0.0};
    to.motion.angular_velocity_rad_s = 2.0;
    if (id % 50 == 0) to.impacts.push_back({frame.media_time, Vec3(0.0, 0.0, 100.0)});
  }
  return frame;
}

class RecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const SteadyClock clock;
    const LocalMediaClock media_clock(clock);
    StreamRecorder recorder({file_, std::nullopt}, media_clock);
    recorder.describe(describe());
    FrameEncoder encoder;
    for (std::uint64_t id = 30; id < 30 + kFrames; ++id) {
      const EncodedFrame frame = encoder.encode(makeFrame(id));
      frames_.push_back(*frame.delta);
      recorder.publish(frame);
      const EncodedVideo video =
          encodeVideo({frame.epoch, id, frame.media_time, {0xFF, 0xD8, std::uint8_t(id)}});
      pictures_.push_back(*video.payload);
      recorder.publish(video);
    }
  }
  [[nodiscard]] StreamReader open() const {
    auto opened = StreamReader::open(file_);
    if (!opened.ok()) throw std::runtime_error(opened.error().message);
    return std::move(opened).value();
  }

  TempFolder folder_;
  std::string file_ = (folder_ / "stream.mcap").string();
  std::vector<std::vector<std::uint8_t>> frames_, pictures_;
};

TEST_F(RecordingTest, TheFirstPassIsByteEqual) {
  RecordingPlayer player(open(), false);
  EXPECT_EQ(player.reader().description(), describe());
  EXPECT_EQ(player.reader().begin(), makeFrame(30).media_time);
  EXPECT_EQ(player.reader().length(), (kFrames - 1) * kPeriod);
  FrameEncoder encoder;
  std::size_t frames = 0, pictures = 0;
  while (const auto due = player.prepare(mediaTime(13.2))) {
    RecordedItem item = player.take();
    if (auto* const frame = std::get_if<CodedFrame>(&item)) {
      EXPECT_EQ(*due, frame->media_time);
      ASSERT_LT(frames, frames_.size());
      EXPECT_EQ(*encoder.encode(std::move(*frame)).delta, frames_[frames]) << frames;
      ++frames;
    } else if (auto* const picture = std::get_if<VideoFrame>(&item)) {
      ASSERT_LT(pictures, pictures_.size());
      EXPECT_EQ(*encodeVideo(std::move(*picture)).payload, pictures_[pictures]) << pictures;
      ++pictures;
    }
  }
  EXPECT_EQ(frames, frames_.size());
  EXPECT_EQ(pictures, pictures_.size());
  EXPECT_EQ(player.reader().problem(), "");
}

/// What must hold of the frames that viewers receive.
class StreamOrder {
 public:
  void add(const CodedFrame& frame) {
    if (last_) {
      EXPECT_GT(frame.id, last_->id);
      EXPECT_GT(frame.media_time, last_->media_time);
      EXPECT_GE(frame.epoch, last_->epoch);
    }
    for (const CodedObject& object : frame.objects) {
      ASSERT_TRUE(object.relief) << frame.id;
      EXPECT_LE(object.changed_in_frame, frame.id);
      const auto [known, is_new] =
          reliefs_.try_emplace({object.id, object.changed_in_frame}, *object.relief);
      EXPECT_EQ(known->second, *object.relief) << "two reliefs have one number";
    }
    last_ = frame;
  }
  [[nodiscard]] const std::optional<CodedFrame>& last() const { return last_; }

 private:
  std::optional<CodedFrame> last_;
  std::map<std::pair<std::uint32_t, std::uint64_t>, CodedRelief> reliefs_;
};

TEST_F(RecordingTest, EveryRequestOfAnOperatorKeepsTheOrder) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high) {
      return std::uniform_real_distribution(low, high)(random);
    };
    RecordingPlayer player(open(), true);
    StreamOrder order;
    MediaTime now = player.reader().begin();
    for (int i = 0; i < 1000; ++i) {
      const double what = draw(0.0, 1.0);
      const auto before = order.last();
      bool jumps = true;
      if (what < 0.02) {
        player.seek(draw(-1.0, 10.0));
      } else if (what < 0.03) {
        player.setSpeed(draw(0.05, 5.0));
      } else if (what < 0.04) {
        now += fromSeconds(draw(0.0, 100.0));  // a pause
        player.resume();
      } else {
        jumps = false;
      }
      const auto due = player.prepare(now);
      ASSERT_TRUE(due) << "with loop there is no end";
      now = std::max(now, *due);
      const RecordedItem item = player.take();
      const auto* const frame = std::get_if<CodedFrame>(&item);
      if (frame == nullptr) continue;
      order.add(*frame);
      if (before && jumps) {
        EXPECT_GT(frame->epoch, before->epoch);
      }
    }
  }
}

TEST_F(RecordingTest, SeekContinuesWithTheFrameOfTheTime) {
  RecordingPlayer player(open(), false);
  for (const int wanted : {150, 3, 199, 77}) {
    player.seek(0.04 * wanted);
    ASSERT_TRUE(player.prepare(mediaTime(100.0)));
    const RecordedItem item = player.take();
    const auto* const frame = std::get_if<CodedFrame>(&item);
    ASSERT_TRUE(frame);
    const auto expected = FrameCoder().code(makeFrame(30 + static_cast<std::uint64_t>(wanted)));
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_TRUE(frame->objects[i].relief);
      EXPECT_EQ(*frame->objects[i].relief, *expected.objects[i].relief) << wanted;
    }
  }
}

TEST_F(RecordingTest, TheSpeedChangesMotionAndTimes) {
  RecordingPlayer player(open(), false);
  player.setSpeed(2.0);
  std::optional<MediaTime> before;
  for (int i = 0; i < 60; ++i) {
    const auto due = player.prepare(mediaTime(13.2));
    ASSERT_TRUE(due);
    const RecordedItem item = player.take();
    const auto* const frame = std::get_if<CodedFrame>(&item);
    if (frame == nullptr) continue;
    if (before) {
      EXPECT_EQ(frame->media_time - *before, kPeriod / 2);
    }
    before = frame->media_time;
    const Motion& motion = frame->objects[0].motion;
    EXPECT_EQ(motion.velocity_mm_s, Vec3(20.0, 0.0, -40.0));
    EXPECT_EQ(motion.acceleration_mm_s2, Vec3(0.0, 400.0, 0.0));
    EXPECT_EQ(motion.angular_velocity_rad_s, 4.0);
    for (const Impact& impact : frame->objects[0].impacts) {
      EXPECT_EQ(impact.delta_velocity_mm_s, Vec3(0.0, 0.0, 200.0));
      EXPECT_EQ(impact.time, frame->media_time);
    }
  }
}

/// Writes a recording of these frames, whatever they are.
std::string writeForeign(const std::string& file, const std::vector<CodedFrame>& frames) {
  const StreamDescription description = describe();
  McapWriter writer(file, {makeChannel("/d", "hapticast.proto.StreamDescription"),
                           makeChannel("/f", "hapticast.proto.HapticFrame")});
  writer.write(0, 0, findContent(encode(description)));
  for (const CodedFrame& frame : frames) writer.write(1, 5, findContent(encode(frame)));
  return file;
}

TEST_F(RecordingTest, FramesWhoseTimesRunBackAreLeftOut) {
  FrameCoder coder;
  std::vector<CodedFrame> frames;
  for (const std::uint64_t id : {40U, 41U, 35U, 42U, 41U})
    frames.push_back(coder.code(makeFrame(id)));
  auto opened = StreamReader::open(writeForeign((folder_ / "back.mcap").string(), frames));
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  RecordingPlayer player(std::move(opened).value(), false);
  std::vector<std::uint64_t> ids;
  while (player.prepare(mediaTime(14.0))) {
    const RecordedItem item = player.take();
    if (const auto* const frame = std::get_if<CodedFrame>(&item)) ids.push_back(frame->id);
  }
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{40, 41, 42}));
  EXPECT_EQ(player.reader().leftOut(), 2U);
}

TEST_F(RecordingTest, AGapIsSkipped) {
  FrameCoder coder;
  std::vector<CodedFrame> frames{coder.code(makeFrame(40)), coder.code(makeFrame(41))};
  frames[1].media_time += std::chrono::hours(24 * 365);
  auto opened = StreamReader::open(writeForeign((folder_ / "gap.mcap").string(), frames));
  ASSERT_TRUE(opened.ok());
  RecordingPlayer player(std::move(opened).value(), false);
  const MediaTime now = frames[0].media_time;
  ASSERT_TRUE(player.prepare(now));
  (void)player.take();
  const auto due = player.prepare(now);
  ASSERT_TRUE(due);
  EXPECT_LT(*due, now + std::chrono::seconds(1));
}

TEST_F(RecordingTest, OtherFilesAreRefused) {
  const auto refuse = [](const std::string& file) {
    const auto opened = StreamReader::open(file);
    return opened.ok() ? "" : opened.error().message;
  };
  EXPECT_EQ(refuse(writeForeign((folder_ / "none.mcap").string(), {})), "has no frames");
  const std::string other = (folder_ / "other.mcap").string();
  {
    McapWriter writer(other, {{"/camera", "cdr", {"sensor_msgs/msg/Image", "ros2msg", ""}}});
    writer.write(0, 1, std::vector<std::uint8_t>(10));
  }
  EXPECT_EQ(refuse(other),
            "has no channel /frame of hapticast: it is no recording of hapticast-server");
  const std::string wrong = (folder_ / "wrong.mcap").string();
  {
    McapWriter writer(wrong, {makeChannel("/frame", "hapticast.proto.HapticFrame")});
    writer.write(0, 1, std::vector<std::uint8_t>{0xFF, 0xFF, 1});
  }
  EXPECT_EQ(refuse(wrong), "has no frames: it has an invalid frame (bytes that are not a message)");
}

}  // namespace
}  // namespace hapticast::server
