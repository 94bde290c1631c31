// SPDX-License-Identifier: MIT
// Recordings of ROS 2 and Foxglove as sources: topics, pairs by time, intrinsics, damage.
#include "server/source/recording/recording_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "server/settings/settings.hpp"
#include "tests/unit/server/image_messages.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;
constexpr std::int64_t kPeriod_ns = 33'333'333;
const cv::Size kClipSize{24, 16};

cv::Mat clipColor(int frame) {
  cv::Mat picture(kClipSize, CV_8UC3);
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      picture.at<cv::Vec3b>(v, u) = cv::Vec3b(uchar(frame), uchar(10 * v), uchar(10 * u));
  return picture;
}

cv::Mat clipDepth_mm(int frame) {
  cv::Mat picture(kClipSize, CV_16UC1);
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      picture.at<std::uint16_t>(v, u) = std::uint16_t(500 + 10 * frame + u + v);
  return picture;
}

std::int64_t stampOf_ns(int frame) { return kStart_ns + frame * kPeriod_ns; }

/// A message of a file.
struct Sent {
  std::size_t channel;
  std::int64_t time_ns;
  MessageBytes bytes;
};

class RecordingSourceTest : public ::testing::Test {
 protected:
  std::string write(const std::string& name, const std::vector<McapChannel>& channels,
                    const std::vector<Sent>& messages) const {
    std::string file = (folder / name).string();
    McapWriter writer(file, channels);
    for (const Sent& each : messages)
      writer.write(each.channel, std::uint64_t(each.time_ns), each.bytes);
    EXPECT_TRUE(writer.finish());
    return file;
  }
  /// Returns the channels of a camera of ROS 2.
  static std::vector<McapChannel> rosChannels() {
    return {rosChannel("/camera/color/image_raw", "Image"),
            rosChannel("/camera/depth/image_raw", "Image"),
            rosChannel("/camera/color/camera_info", "CameraInfo"), rosChannel("/imu", "Imu")};
  }
  /// Returns `count` frames of that camera. The depth is 3 ms later than the colour.
  static std::vector<Sent> rosFrames(int count) {
    std::vector<Sent> messages;
    for (int i = 0; i < count; ++i) {
      const std::int64_t time_ns = stampOf_ns(i);
      messages.push_back({2, time_ns, rosCameraInfo(kClipSize, 20.0, {.stamp_ns = time_ns})});
      messages.push_back({0, time_ns, rosImage(clipColor(i), "bgr8", {.stamp_ns = time_ns})});
      messages.push_back({3, time_ns, {1, 2, 3}});
      messages.push_back(
          {1, time_ns, rosImage(clipDepth_mm(i), "16UC1", {.stamp_ns = time_ns + 3'000'000})});
    }
    return messages;
  }
  /// Requires the next frame of `source` to be number `frame` at `index`.
  static void expectFrame(RgbdSource& source, int frame, std::uint64_t index) {
    const auto read = source.read();
    ASSERT_TRUE(read) << frame;
    EXPECT_EQ(read->index, index);
    EXPECT_EQ(cv::norm(read->color, clipColor(frame), cv::NORM_INF), 0.0) << frame;
    cv::Mat depth;
    clipDepth_mm(frame).convertTo(depth, CV_32F);
    EXPECT_EQ(cv::norm(read->depth, depth, cv::NORM_INF), 0.0) << frame;
  }
  static std::string errorWith(const std::string& file, const std::string& topics) {
    VideoLayout layout;
    layout.topics = topics;
    return errorOf([&] { (void)openSource(file, 0.0, false, layout); });
  }
  SourceFolder folder;
};

TEST_F(RecordingSourceTest, EachFrameOfROS2Comes) {
  const auto source = openSource(write("ros.mcap", rosChannels(), rosFrames(10)), 0.0);
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.name, "ros.mcap");
  EXPECT_EQ(info.fps, 30.0);
  EXPECT_EQ(info.frame_count, 10U);
  EXPECT_EQ(info.mm_per_unit, 1.0);
  EXPECT_EQ(info.camera, (CameraModel{20.0, 40.0, 12.5, 4.5}));
  for (int loop = 0; loop < 2; ++loop) {
    for (int i = 0; i < 10; ++i) expectFrame(*source, i, std::uint64_t(i));
    EXPECT_FALSE(source->read());
    source->rewind();
  }
  EXPECT_TRUE(source->skip());
  EXPECT_TRUE(source->skip());
  expectFrame(*source, 2, 2);
}

TEST_F(RecordingSourceTest, EachFrameOfFoxgloveComes) {
  std::vector<Sent> messages;
  for (int i = 0; i < 5; ++i) {
    messages.push_back(
        {0, 1, foxgloveCompressed(encodeFile(".png", clipColor(i)), "png", stampOf_ns(i))});
    messages.push_back({1, 1, foxgloveImage(clipDepth_mm(i), "16UC1", stampOf_ns(i))});
  }
  messages.push_back({2, 1, foxgloveCalibration({48, 32}, 40.0)});  // of pictures twice as large
  const auto source = openSource(
      write("foxglove.mcap",
            {foxgloveChannel("/color", "CompressedImage"), foxgloveChannel("/depth", "RawImage"),
             foxgloveChannel("/calibration", "CameraCalibration")},
            messages),
      10.0);
  EXPECT_EQ(source->info().fps, 10.0);
  EXPECT_EQ(source->info().camera, (CameraModel{20.0, 40.0, 12.25, 4.25}));
  for (int i = 0; i < 5; ++i) expectFrame(*source, i, std::uint64_t(i));
  EXPECT_FALSE(source->read());
}

TEST_F(RecordingSourceTest, TheUnitOfDepthIsThatOfItsValues) {
  std::vector<Sent> messages = rosFrames(2);
  cv::Mat depth_m;
  for (int i = 0; i < 2; ++i) {
    clipDepth_mm(i).convertTo(depth_m, CV_32F, 1e-3);
    messages[std::size_t(4 * i + 3)].bytes =
        rosImage(depth_m, "32FC1", {.stamp_ns = stampOf_ns(i)});
  }
  const std::string file = write("metres.mcap", rosChannels(), messages);
  const auto metres = openSource(file, 0.0);
  EXPECT_EQ(metres->info().mm_per_unit, 1000.0);
  EXPECT_NEAR(metres->read()->depth.at<float>(0, 0), 500.0F, 1e-3);
  VideoLayout layout;
  layout.depth_unit_mm = 100.0;
  EXPECT_NEAR(openSource(file, 0.0, false, layout)->read()->depth.at<float>(0, 0), 50.0F, 1e-3);
}

TEST_F(RecordingSourceTest, TimesDecideThePairs) {
  std::vector<Sent> messages;
  for (int i = 0; i < 12; ++i) {
    const std::int64_t time_ns = stampOf_ns(i);
    // Depth has half of the rate, and colour 4 is lost.
    if (i != 4)
      messages.push_back({0, time_ns, rosImage(clipColor(i), "bgr8", {.stamp_ns = time_ns})});
    if (i % 2 == 0)
      messages.push_back({1, time_ns, rosImage(clipDepth_mm(i), "16UC1", {.stamp_ns = time_ns})});
  }
  std::swap(messages[0], messages[2]);  // times that run back
  const LogLines log;
  const auto source = openSource(write("gaps.mcap", rosChannels(), messages), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("/camera/color/image_raw has an image with an earlier time"));
  EXPECT_THAT(log.text(), HasSubstr("6 colour images have no depth, and 1 depth images no colour"));
  EXPECT_EQ(source->info().fps, 15.0);
  EXPECT_EQ(source->info().frame_count, 6U);
  for (const int frame : {0, 2, 6, 8, 10}) expectFrame(*source, frame, std::uint64_t(frame / 2));
  EXPECT_FALSE(source->read());
}

TEST_F(RecordingSourceTest, WithoutStampsTheLogDecides) {
  std::vector<Sent> messages;
  for (int i = 0; i < 4; ++i) {
    messages.push_back({0, stampOf_ns(i), rosImage(clipColor(i), "bgr8", {.stamp_ns = 0})});
    messages.push_back(
        {1, stampOf_ns(i), rosImage(clipDepth_mm(i), "16UC1", {.stamp_ns = 5'000 + i})});
  }
  const auto source = openSource(write("log.mcap", rosChannels(), messages), 0.0);
  EXPECT_EQ(source->info().fps, 30.0);
  for (int i = 0; i < 4; ++i) expectFrame(*source, i, std::uint64_t(i));
}

TEST_F(RecordingSourceTest, TopicsThatAreNotClearAreListed) {
  std::vector<McapChannel> channels = rosChannels();
  channels.push_back(rosChannel("/left/image", "Image"));
  std::vector<Sent> messages = rosFrames(3);
  messages.push_back({4, stampOf_ns(0), rosImage(clipColor(0), "mono8")});
  messages.back().bytes = rosImage(clipColor(7), "rgb8", {.stamp_ns = stampOf_ns(0)});
  const std::string file = write("two.mcap", channels, messages);
  EXPECT_THAT(openError(file),
              HasSubstr("name them with --topics COLOR,DEPTH; colour is in "
                        "/camera/color/image_raw, /left/image; depth is in /camera/depth"));
  VideoLayout layout;
  layout.topics = "/camera/color/image_raw,/camera/depth/image_raw";
  expectFrame(*openSource(file, 0.0, false, layout), 0, 0);
  EXPECT_THAT(errorWith(file, "/camera/color/image_raw"), HasSubstr("is not COLOR,DEPTH"));
  EXPECT_THAT(errorWith(file, "/imu,/camera/depth/image_raw"),
              HasSubstr("has no images of the topic '/imu'; its topics are"));
  EXPECT_THAT(errorWith(file, "/camera/depth/image_raw,/left/image"),
              HasSubstr("/camera/depth/image_raw of " + file + " has depth (16UC1); use"));
}

TEST_F(RecordingSourceTest, AFileWithoutBothIsRefusedWithItsTopics) {
  const std::string imu = write("imu.mcap", {rosChannel("/imu", "Imu"), {"/text", "json", {}}},
                                {{0, 1, {1}}, {1, 2, {2}}});
  EXPECT_THAT(openError(imu),
              HasSubstr("has no images of colour and depth that the server reads; its topics are "
                        "/imu (sensor_msgs/msg/Imu), /text (json)"));
  const std::string bayer = write("bayer.mcap", rosChannels(),
                                  {{0, 1, rosImage(clipDepth_mm(0), "bayer_rggb16")},
                                   {1, 1, rosImage(clipDepth_mm(0), "16UC1")}});
  EXPECT_THAT(openError(bayer), HasSubstr("has no images of colour that the server reads"));
  EXPECT_THAT(openError(bayer),
              HasSubstr("/camera/color/image_raw (sensor_msgs/msg/Image, has the "
                        "encoding 'bayer_rggb16', which the server does not read)"));
  const std::string own =
      write("own.mcap", {{"/frame", "protobuf", {"hapticast.proto.HapticFrame", "protobuf", ""}}},
            {{0, 1, {1}}});
  EXPECT_THAT(openError(own), HasSubstr("is a recording of hapticast-server"));
  EXPECT_THAT(openError(folder.TempFolder::write("text.mcap", "no recording")),
              HasSubstr("is no MCAP file"));
}

TEST_F(RecordingSourceTest, OnlyARecordingOfHapticastPlaysWithoutVision) {
  Settings settings;
  settings.source = write("ros.mcap", rosChannels(), rosFrames(2));
  EXPECT_FALSE(isRecording(settings));
  settings.source =
      write("own.mcap", {{"/frame", "protobuf", {"hapticast.proto.HapticFrame", "protobuf", ""}}},
            {{0, 1, {1}}});
  EXPECT_TRUE(isRecording(settings));
  settings.source = (folder / "none.mcap").string();
  EXPECT_FALSE(isRecording(settings));
}

TEST_F(RecordingSourceTest, FlagsOfOtherSourcesAreRefused) {
  const std::string file = write("ros.mcap", rosChannels(), rosFrames(2));
  VideoLayout layout;
  layout.layout = Layout::kSideBySide;
  const auto errorOfLayout = [&] {
    return errorOf([&] { (void)openSource(file, 0.0, false, layout); });
  };
  EXPECT_THAT(errorOfLayout(), HasSubstr("only a single video file has a --layout"));
  layout = {};
  layout.code = DepthCode::kInverse;
  EXPECT_THAT(errorOfLayout(), HasSubstr("leave the flag out"));
  EXPECT_THAT(errorOf([&] { (void)openSource(file, 0.0, true); }), HasSubstr("--to-and-fro"));
  EXPECT_THAT(errorWith("synthetic:still", "/a,/b"),
              HasSubstr("only a recording (MCAP) has --topics"));
}

TEST_F(RecordingSourceTest, TwoViewsAndClocksAreNamed) {
  std::vector<Sent> messages = rosFrames(2);
  messages[3].bytes =
      rosImage(clipDepth_mm(0), "16UC1", {.stamp_ns = stampOf_ns(0), .frame_id = "depth_frame"});
  const LogLines log;
  (void)openSource(write("views.mcap", rosChannels(), messages), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("its depth is seen from 'depth_frame' and its colour from "
                                    "'camera'"));
  for (const std::size_t depth : {3U, 7U})
    messages[depth].bytes = rosImage(clipDepth_mm(0), "16UC1", {.stamp_ns = 77});
  EXPECT_THAT(openError(write("clocks.mcap", rosChannels(), messages)),
              HasSubstr("both need the same clock"));
  messages = rosFrames(3);
  messages[8].bytes = rosImage(clipColor(2), "bgr8", {.stamp_ns = 1});
  messages[9].bytes = messages[11].bytes = rosImage(clipDepth_mm(2), "16UC1", {.stamp_ns = 1});
  EXPECT_THAT(openError(write("jump.mcap", rosChannels(), messages)),
              HasSubstr("span more than 11 days"));
}

TEST_F(RecordingSourceTest, AnUnreadableFrameIsLeftOut) {
  std::vector<Sent> messages = rosFrames(4);
  messages[5].bytes = rosImage(clipColor(1).rowRange(0, 8), "bgr8", {.stamp_ns = stampOf_ns(1)});
  messages[11].bytes.resize(messages[11].bytes.size() - 1);  // its stamp is lost, too
  const LogLines log;
  const auto source = openSource(write("some.mcap", rosChannels(), messages), 0.0);
  expectFrame(*source, 0, 0);
  expectFrame(*source, 3, 3);
  EXPECT_FALSE(source->read());
  EXPECT_THAT(log.text(), HasSubstr("is 24x8, but the first picture is 24x16; frames 1 to 2 are"));
}

TEST_F(RecordingSourceTest, AFileThatWasCutOffPlaysToItsEnd) {
  const std::string file = (folder / "cut.mcap").string();
  {
    McapWriter writer(file, rosChannels());
    for (const Sent& each : rosFrames(6)) {
      writer.write(each.channel, std::uint64_t(each.time_ns), each.bytes);
      writer.flush();
    }
  }
  const auto size = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, size * 2 / 3);
  const LogLines log;
  const auto source = openSource(file, 0.0);
  EXPECT_THAT(log.text(), HasSubstr("is cut off; the server plays the images before that"));
  int count = 0;
  while (source->read()) ++count;
  EXPECT_GE(count, 3);
  EXPECT_LT(count, 6);
}

TEST_F(RecordingSourceTest, ABagIsAFolderWithOneRecording) {
  folder.TempFolder::write("bag/metadata.yaml", "rosbag2_bagfile_information:\n");
  const std::string bag = (folder / "bag").string();
  (void)write("bag/bag_0.mcap", rosChannels(), rosFrames(2));
  expectFrame(*openSource(bag, 0.0), 0, 0);
  (void)write("bag/bag_1.mcap", rosChannels(), rosFrames(2));
  EXPECT_THAT(openError(bag), HasSubstr("is a bag of 2 MCAP files"));
  folder.TempFolder::write("packed/metadata.yaml", "rosbag2_bagfile_information:\n");
  folder.TempFolder::write("packed/packed_0.mcap.zstd", "\x28\xB5\x2F\xFD and more");
  EXPECT_THAT(openError((folder / "packed").string()),
              HasSubstr("packed_0.mcap.zstd: is compressed; unpack it (unzstd FILE)"));
  folder.TempFolder::write("old/metadata.yaml", "rosbag2_bagfile_information:\n");
  const std::string database =
      folder.TempFolder::write("old/old_0.db3", "SQLite format 3 and more");
  EXPECT_EQ(openError((folder / "old").string()),
            database +
                ": is a ROS 2 bag of SQLite; convert it (echo 'output_bags: [{uri: old_0_mcap, "
                "storage_id: mcap, all: true}]' > out.yaml; ros2 bag convert -i " +
                database + " -o out.yaml), and use the folder old_0_mcap");
}

TEST_F(RecordingSourceTest, DamagedFilesAreRefusedOrPlay) {
  const std::string file = write("whole.mcap", rosChannels(), rosFrames(3));
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  std::mt19937 random(7);
  const LogLines log;
  int opened = 0;
  constexpr int kRounds = 300;
  for (int round = 0; round < kRounds; ++round) {
    std::string bytes = whole;
    if (round % 3 == 0) bytes.resize(random() % bytes.size());
    for (int i = 0; i < 3 && !bytes.empty(); ++i)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    const std::string damaged = folder.TempFolder::write("damaged.mcap", bytes);
    try {
      const auto source = openSource(damaged, 0.0);
      while (source->read()) {
      }
      ++opened;
    } catch (const SourceError& error) {
      EXPECT_THAT(error.what(), HasSubstr("damaged.mcap"));
    }
  }
  EXPECT_LT(opened, kRounds);
}

}  // namespace
}  // namespace hapticast::server
