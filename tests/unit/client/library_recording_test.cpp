// SPDX-License-Identifier: MIT
// Recordings through the library: frames with all heights and their pictures, ticks, seeks, damage.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <random>

#include "client/desk/run_recorder.hpp"
#include "client/device/profile/device_profile.hpp"
#include "client/include/hapticast/recording.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/mcap_writer.hpp"
#include "common/recording/schemas.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast {
namespace {

constexpr std::uint64_t kFrames = 150;
constexpr Duration kPeriod = std::chrono::milliseconds(40);

StreamDescription describeBodies() {
  StreamDescription description;
  description.name = "two bodies";
  description.workspace.width_px = 64;
  description.workspace.height_px = 48;
  return description;
}

MediaTime timeOf(std::uint64_t id) {
  return mediaTime(12.0) + static_cast<std::int64_t>(id) * kPeriod;
}

/// A viewer's frame: object 1 changes always, object 2 in every `repeat`-th frame. Its height is
/// that of its last change.
CodedFrame makeBodies(std::uint64_t id, std::uint64_t repeat) {
  HapticFrame frame;
  frame.epoch = 3;
  frame.id = id;
  frame.media_time = timeOf(id);
  for (const std::uint32_t object : {1U, 2U}) {
    const std::uint64_t changed = object == 1 ? id : id - id % repeat;
    HapticObject& to = frame.objects.emplace_back();
    to.id = object;
    to.changed_in_frame = changed;
    to.relief = flatRelief({0, 0, 8, 8}, 1.0F + 0.1F * static_cast<float>(changed));
  }
  CodedFrame coded = FrameCoder().code(frame);
  if (id % repeat != 0) coded.objects[1].relief.reset();
  return coded;
}

VideoFrame makePicture(std::uint64_t id) {
  return {3, id, timeOf(id), {0xFF, 0xD8, static_cast<std::uint8_t>(id)}};
}

client::TickReport makeTick(std::uint64_t number, LocalTime time) {
  client::TickReport tick;
  tick.tick = number;
  tick.time = time;
  tick.play_time = mediaTime(12.0);
  tick.playout_delay = std::chrono::milliseconds(80);
  tick.inputs.reading.position_mm = {1.0, 2.0, 3.0};
  tick.inputs.reading.buttons = 2;
  tick.hip_mm = {4.0, 5.0, 6.0};
  tick.force_N = {0.0, 0.0, 1e-3 * static_cast<double>(number)};
  tick.static_force_N = {0.5, 0.0, 0.0};
  tick.dynamic_force_N = {0.0, 0.25, 0.0};
  tick.penetration_mm = 1.5;
  tick.contact = true;
  tick.lookup = client::Lookup::kHeld;
  tick.fault = client::Fault::kLatency;
  tick.safety_actions = 5;
  return tick;
}

class LibraryRecording : public ::testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// Returns a recording as hapticast-server writes it.
  [[nodiscard]] std::string recordServer() const {
    McapWriter writer(path("server.mcap"),
                      {makeChannel("/description", "hapticast.proto.StreamDescription"),
                       makeChannel("/frame", "hapticast.proto.HapticFrame"),
                       makeChannel("/picture", "foxglove.CompressedImage")});
    for (std::uint64_t id = 0; id < kFrames; ++id) {
      const auto time_ns = static_cast<std::uint64_t>(timeOf(id).time_since_epoch().count());
      const auto description = encode(describeBodies()), frame = encode(makeBodies(id, 25));
      if (id == 0 || id % 25 == 13) writer.write(0, time_ns, findContent(description));
      writer.write(1, time_ns, findContent(frame));
      if (id % 7 != 3) writer.write(2, time_ns, encodePictureContent(makePicture(id)));
      if (id % 10 == 9) writer.flush();
    }
    return path("server.mcap");
  }
  /// Returns a recording as hapticast-client writes it: object 2 arrives once, and some pictures
  /// arrive before their frames.
  [[nodiscard]] std::string recordClient() const {
    ManualClock clock;
    client::RunRecorder recorder({path("client.mcap"), std::nullopt}, clock);
    recorder.onSettings({.profile = client::loadDeviceProfile("omni")});
    recorder.onDescription(describeBodies());
    for (std::uint64_t tick = 0; tick < 40 * kFrames; ++tick) {
      if (tick % 40 == 0) {
        const std::uint64_t id = tick / 40;
        client::AssembledFrame frame;
        frame.place.epoch = 1;
        frame.frame = makeBodies(id, 1000);
        if (id % 3 == 0) recorder.onPicture(makePicture(id));
        recorder.onFrame(frame);
        if (id % 3 == 1) recorder.onPicture(makePicture(id));
      }
      clock.advance(std::chrono::milliseconds(1));
      recorder.onTick(makeTick(tick + 1, clock.now()));
    }
    return path("client.mcap");
  }
  static std::vector<Frame> readFrames(Recording& recording) {
    std::vector<Frame> frames;
    while (auto frame = recording.nextFrame()) frames.push_back(std::move(*frame));
    return frames;
  }
  static void expectSame(const Frame& frame, const Frame& other) {
    EXPECT_EQ(frame.id, other.id);
    EXPECT_EQ(frame.time_s, other.time_s);
    EXPECT_EQ(frame.jpeg, other.jpeg);
    ASSERT_EQ(frame.objects.size(), other.objects.size());
    for (std::size_t i = 0; i < frame.objects.size(); ++i) {
      ASSERT_TRUE(frame.objects[i].heights && other.objects[i].heights);
      EXPECT_EQ(frame.objects[i].heights->height_mm, other.objects[i].heights->height_mm);
      EXPECT_EQ(frame.objects[i].heights->mask, other.objects[i].heights->mask);
    }
  }

  TempFolder folder_;
};

TEST_F(LibraryRecording, FramesHaveAllHeightsAndTheirPictures) {
  for (const bool of_client : {false, true}) {
    SCOPED_TRACE(of_client);
    Recording recording(of_client ? recordClient() : recordServer());
    EXPECT_EQ(recording.kind() == Recording::Kind::kClient, of_client);
    ASSERT_TRUE(recording.info());
    EXPECT_EQ(recording.info()->name, "two bodies");
    const std::vector<Frame> frames = readFrames(recording);
    ASSERT_EQ(frames.size(), kFrames);
    for (std::uint64_t id = 0; id < kFrames; ++id) {
      const Frame& frame = frames[id];
      EXPECT_EQ(frame.id, id);
      EXPECT_DOUBLE_EQ(frame.time_s, toSeconds(timeOf(id)));
      ASSERT_EQ(frame.objects.size(), 2U);
      ASSERT_TRUE(frame.objects[0].heights && frame.objects[1].heights);
      const std::uint64_t changed = of_client ? 0 : id - id % 25;
      EXPECT_NEAR(frame.objects[0].heights->height_mm.at(0), 1.0 + 0.1 * double(id), 0.021);
      EXPECT_NEAR(frame.objects[1].heights->height_mm.at(0), 1.0 + 0.1 * double(changed), 0.021);
      const bool has_picture = of_client ? id % 3 != 2 : id % 7 != 3;
      ASSERT_EQ(frame.jpeg.size(), has_picture ? 3U : 0U) << id;
      if (has_picture) {
        EXPECT_EQ(frame.jpeg[2], id);
      }
    }
    const RecordingCounts counts = recording.count();
    EXPECT_EQ(counts.frames, kFrames);
    EXPECT_EQ(counts.ticks, of_client ? 40 * kFrames : 0U);
    EXPECT_EQ(counts.pictures, of_client ? 100U : 129U);
    EXPECT_EQ(counts.problem + recording.problem(), "");
    EXPECT_FALSE(recording.nextFrame());
  }
}

TEST_F(LibraryRecording, TicksAreThoseOfTheRun) {
  Recording recording(recordClient());
  std::uint64_t number = 0;
  while (const auto tick = recording.nextTick()) {
    ++number;
    const LocalTime time = localTime(1.0) + static_cast<std::int64_t>(number) * kTickPeriod;
    ASSERT_EQ(tick->tick, number);
    EXPECT_DOUBLE_EQ(tick->time_s, toSeconds(time));
    EXPECT_EQ(tick->force_N, makeTick(number, time).force_N);
  }
  EXPECT_EQ(number, 40 * kFrames);
  recording.seek(0);
  const auto tick = recording.nextTick();
  ASSERT_TRUE(tick);
  EXPECT_EQ(tick->tick, 1U);
  EXPECT_EQ(tick->play_time_s, 12.0);
  EXPECT_EQ(tick->playout_delay_s, 0.08);
  EXPECT_EQ(tick->reading_mm, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(tick->hip_mm, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_EQ(tick->static_force_N, Eigen::Vector3d(0.5, 0.0, 0.0));
  EXPECT_EQ(tick->dynamic_force_N, Eigen::Vector3d(0.0, 0.25, 0.0));
  EXPECT_EQ(tick->penetration_mm, 1.5);
  EXPECT_EQ(tick->buttons, 2U);
  EXPECT_EQ(tick->safety_actions, 5U);
  EXPECT_EQ(listLookups().at(tick->lookup), "held");
  EXPECT_EQ(listFaults().at(tick->fault), "latency");
  EXPECT_TRUE(tick->contact);
  EXPECT_FALSE(tick->stopping);
}

TEST_F(LibraryRecording, ASeekGivesTheFramesAndTicksOfTheWhole) {
  std::mt19937 random(7);
  for (const bool of_client : {false, true}) {
    SCOPED_TRACE(of_client);
    Recording recording(of_client ? recordClient() : recordServer());
    const std::vector<Frame> whole = readFrames(recording);
    for (int i = 0; i < 20; ++i) {
      // A place between two frames; frame `first` is the next one.
      const std::uint64_t first = 1 + random() % (kFrames - 1);
      recording.seek(recording.start_ns() +
                     (static_cast<std::int64_t>(first) * kPeriod - kPeriod / 2).count());
      const std::vector<Frame> rest = readFrames(recording);
      ASSERT_EQ(rest.size(), kFrames - first);
      for (std::size_t j = 0; j < rest.size(); ++j) expectSame(rest[j], whole[first + j]);
      const auto tick = recording.nextTick();
      ASSERT_EQ(tick.has_value(), of_client);
      if (tick) {
        EXPECT_EQ(tick->tick, 40 * first - 20);
      }
    }
    recording.seek(std::numeric_limits<std::int64_t>::max());
    EXPECT_FALSE(recording.nextFrame() || recording.nextTick());
    recording.seek(std::numeric_limits<std::int64_t>::min());
    EXPECT_EQ(readFrames(recording).size(), kFrames);
  }
}

TEST_F(LibraryRecording, ADamagedRecordingHasItsBegin) {
  std::mt19937 random(3);
  for (const bool of_client : {false, true}) {
    Recording undamaged(of_client ? recordClient() : recordServer());
    const std::vector<Frame> whole = readFrames(undamaged);
    std::ifstream in(path(of_client ? "client.mcap" : "server.mcap"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    for (int i = 0; i < 60; ++i) {
      std::string damaged = bytes.substr(0, bytes.size() - random() % (bytes.size() / 2));
      if (i % 2 == 0) damaged[random() % damaged.size()] ^= static_cast<char>(1 + random() % 255);
      try {
        Recording recording(folder_.write("damaged.mcap", damaged));
        const std::vector<Frame> frames = readFrames(recording);
        ASSERT_LE(frames.size(), whole.size());
        for (std::size_t j = 0; j < frames.size(); ++j) expectSame(frames[j], whole[j]);
        const RecordingCounts counts = recording.count();
        EXPECT_EQ(counts.frames, frames.size());
        if (frames.size() < whole.size()) {
          EXPECT_NE(recording.problem(), "");
          EXPECT_NE(counts.problem, "");
        }
      } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("damaged.mcap: "), std::string::npos);
      }
    }
  }
}

TEST_F(LibraryRecording, OtherFilesAreRefused) {
  const auto refuse = [](const std::string& file) -> std::string {
    try {
      const Recording recording(file);
      return "";
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(refuse(path("none.mcap")),
            path("none.mcap") + ": cannot be read (No such file or directory)");
  const std::string text = folder_.write("text.mcap", "no recording");
  EXPECT_EQ(refuse(text), text + ": is no MCAP file");
  {
    McapWriter writer(path("other.mcap"), {{"/a", "json", {}}});
    writer.write(0, 1, std::vector<std::uint8_t>{'1'});
  }
  EXPECT_EQ(refuse(path("other.mcap")),
            path("other.mcap") +
                ": has no channel /frame or /tick of hapticast: it is no recording of "
                "hapticast-server or hapticast-client");
}

}  // namespace
}  // namespace hapticast
