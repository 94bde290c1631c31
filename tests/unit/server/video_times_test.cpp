// SPDX-License-Identifier: MIT
// Pairs of videos whose times say which frames belong together. Frame n of each video shows its
// number: colour is evenly 10 + 4 n bright, depth 500 + 100 n mm.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <vector>

#include "server/source/video/frame_times.hpp"
#include "server/source/video/video_clip.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kH264 = "-c:v libx264 -pix_fmt yuv420p -qp 4 ";
constexpr const char* kLossless = "-c:v ffv1 -pix_fmt bgr0 ";
constexpr const char* kDepth = "-c:v ffv1 -pix_fmt gray16le ";

/// A frame as a test reads it.
struct Read {
  std::uint64_t index = 0;
  int color = 0;  ///< number that the colour shows
  int depth = 0;
  double time_s = 0.0;
  bool operator==(const Read&) const = default;
};

class VideoTimes : public VideoFilesTest {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }

  /// Writes a video of `frames` frames without the frames `dropped`; the others keep their times.
  void write(const std::string& name, bool depth, int frames, const std::set<int>& dropped,
             const std::string& codec, const std::string& rate = "24") const {
    std::ofstream out(folder / "v.raw", std::ios::binary);
    for (int i = 0; i < frames; ++i) {
      const cv::Mat picture = depth ? cv::Mat(48, 64, CV_16UC1, cv::Scalar(500 + 100 * i))
                                    : cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(10 + 4 * i));
      out.write(reinterpret_cast<const char*>(picture.data),
                static_cast<std::streamsize>(picture.total() * picture.elemSize()));
    }
    out.close();
    std::string left_out = "0";
    for (const int i : dropped) left_out += "+eq(n," + std::to_string(i) + ")";
    ffmpeg(
        fmt::format("-f rawvideo -pix_fmt {} -s 64x48 -r {} -i v.raw -vf "
                    "\"select='not({})'\" -vsync vfr {}{}",
                    depth ? "gray16le" : "bgr24", rate, left_out, codec, name));
  }
  void writeColor(int frames, const std::set<int>& dropped) const {
    write("c.mp4", false, frames, dropped, kH264);
  }
  void writeDepth(int frames, const std::set<int>& dropped) const {
    write("d.mkv", true, frames, dropped, kDepth);
  }
  [[nodiscard]] VideoClip open(double fps = 0.0) const {
    return VideoClip(at("c.mp4"), at("d.mkv"), fps);
  }
  [[nodiscard]] static Read describe(const RgbdFrame& frame) {
    return {frame.index,
            static_cast<int>(std::lround((frame.color.at<cv::Vec3b>(9, 9)[1] - 10) / 4.0)),
            static_cast<int>(std::lround((frame.depth.at<float>(9, 9) - 500.0F) / 100.0F)),
            frame.clip_time_s};
  }
  [[nodiscard]] static std::vector<Read> readAll(RgbdSource& source) {
    std::vector<Read> frames;
    while (const auto frame = source.read()) frames.push_back(describe(*frame));
    return frames;
  }
  /// Frames `numbers` of a pair at 24 frames/s, each with its own depth.
  [[nodiscard]] static std::vector<Read> own(const std::vector<int>& numbers, double fps = 24.0) {
    std::vector<Read> frames;
    frames.reserve(numbers.size());
    for (const int i : numbers) frames.push_back({static_cast<std::uint64_t>(i), i, i, i / fps});
    return frames;
  }
};

TEST_F(VideoTimes, AColourVideoWithDroppedFramesHasTheDepthOfItsTimes) {
  writeColor(12, {3, 4});
  writeDepth(12, {});
  const LogLines log;
  VideoClip source = open();
  EXPECT_EQ(source.info().fps, 24.0);
  EXPECT_EQ(source.info().frame_count, 12U);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(),
              HasSubstr("d.mkv: has no colour for 2 of its frames, the first at 0.125"));
  const std::vector<int> kept{0, 1, 2, 5, 6, 7, 8, 9, 10, 11};
  EXPECT_EQ(readAll(source), own(kept));
  source.rewind();
  EXPECT_EQ(readAll(source), own(kept));
  source.rewind();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(source.skip());
  EXPECT_EQ(source.read()->index, 5U) << "the gap counts";
  EXPECT_EQ(log.count(), 1) << log.text();
}

TEST_F(VideoTimes, DroppedDepthIsAGap) {
  writeColor(12, {});
  writeDepth(12, {5, 6, 11});
  const LogLines log;
  VideoClip source = open();
  EXPECT_THAT(log.text(), HasSubstr("c.mp4: has no depth for 3 of its frames, the first at 0.208"));
  EXPECT_EQ(readAll(source), own({0, 1, 2, 3, 4, 7, 8, 9, 10}));
  EXPECT_EQ(log.count(), 2) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("c.mp4: frame 5 has no depth at its time; frames 5 to 6 are"));
}

TEST_F(VideoTimes, TheCallersRateChangesThePaceOnly) {
  writeColor(12, {3, 4});
  writeDepth(12, {});
  VideoClip source = open(12.0);
  EXPECT_EQ(readAll(source), own({0, 1, 2, 5, 6, 7, 8, 9, 10, 11}, 12.0));
}

TEST_F(VideoTimes, AConstantOffsetBetweenTheFilesDoesNotMatter) {
  writeColor(12, {3});
  writeDepth(12, {7});
  ffmpeg("-i d.mkv -c copy -output_ts_offset 5 later.mkv");
  VideoClip source(at("c.mp4"), at("later.mkv"), 0.0);
  EXPECT_EQ(readAll(source), own({0, 1, 2, 4, 5, 6, 8, 9, 10, 11}));
}

TEST_F(VideoTimes, DepthOfHalfTheRateIsUsedTwice) {
  write("c.mp4", false, 24, {}, kH264, "30");
  write("d.mkv", true, 12, {}, kDepth, "15");
  VideoClip source = open();
  const auto frames = readAll(source);
  ASSERT_EQ(frames.size(), 24U);
  for (const Read& frame : frames) {
    EXPECT_EQ(frame.index, static_cast<std::uint64_t>(frame.color));
    EXPECT_NEAR(frame.depth, frame.color / 2.0, 0.5);
  }
}

TEST_F(VideoTimes, NumbersDecideForAsManyFramesAtAnotherConstantRate) {
  writeColor(12, {});
  write("d.mkv", true, 12, {}, kDepth, "25");
  const LogLines log;
  VideoClip source = open();
  EXPECT_THAT(log.text(), HasSubstr("d.mkv: has 25 frames/s, but the colour video has 24"));
  EXPECT_EQ(readAll(source), own({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_EQ(log.count(), 1) << log.text();
}

TEST_F(VideoTimes, NumbersDecideForDepthThatAProgramMadeFrameByFrame) {
  writeColor(12, {3, 4});
  writeDepth(10, {});
  const LogLines log;
  VideoClip source = open();
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), AllOf(HasSubstr("d.mkv: has as many frames as the colour video"),
                                HasSubstr("0.42 s"), HasSubstr("0.50 s")));
  const auto frames = readAll(source);
  ASSERT_EQ(frames.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(frames[i].index, i);
    EXPECT_EQ(frames[i].depth, static_cast<int>(i));
  }
}

TEST_F(VideoTimes, VeryDifferentDurationsAreRefused) {
  writeColor(40, {3, 4});
  writeDepth(30, {});
  EXPECT_THAT(errorOf([&] { (void)open(); }),
              AllOf(HasSubstr("d.mkv: lasts 1.25 s, but the colour video lasts 1.67 s"),
                    HasSubstr("cut both")));
}

TEST_F(VideoTimes, DamagedDepthDoesNotMoveTheOthers) {
  writeColor(12, {3});
  write("d.mkv", true, 12, {}, "-c:v png -pix_fmt gray16be ");
  std::ifstream in(folder / "d.mkv", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  folder.write("d.mkv", bytes);
  VideoClip source = open();
  const LogLines log;
  const auto frames = readAll(source);
  EXPECT_EQ(frames.size(), 10U);
  for (const Read& frame : frames) EXPECT_EQ(frame, own({frame.color}).front());
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("has depth that cannot be decoded"));
}

TEST_F(VideoTimes, AVideoOnItsSideIsToBeTurned) {
  ffmpeg("-f lavfi -i testsrc=size=48x64:rate=24 -frames:v 12 -c:v mjpeg side.avi");
  writeDepth(12, {});
  EXPECT_THAT(errorOf([&] { VideoClip(at("side.avi"), at("d.mkv"), 0.0); }),
              AllOf(HasSubstr("d.mkv: is 64x48, but the colour video is 48x64; turn it by 90 "
                              "degrees (ffmpeg -i FILE -vf transpose=1 OUT)")));
}

/// Frames that a device lost: each inner one with the probability `share`.
std::set<int> draw(std::mt19937& random, int frames, double share) {
  std::bernoulli_distribution lost(share);
  std::set<int> dropped;
  for (int i = 1; i + 1 < frames; ++i) {
    if (lost(random)) dropped.insert(i);
  }
  return dropped;
}

TEST_F(VideoTimes, NoPairIsWrongWhateverFramesAreDropped) {
  std::mt19937 random(20261127);
  constexpr int kFrames = 48;
  const std::vector<std::string> rates{"24", "25", "30", "30000/1001", "15"};
  int wrong = 0;
  for (int round = 0; round < 10; ++round) {
    SCOPED_TRACE(round);
    const std::string& rate = rates[static_cast<std::size_t>(round) % rates.size()];
    const auto colors = draw(random, kFrames, 0.03 * round);
    const auto depths = draw(random, kFrames, 0.03 * (9 - round));
    write("c.mp4", false, kFrames, colors,
          round < 5 ? kH264 : kLossless + std::string("-f matroska "), rate);
    write("d.mkv", true, kFrames, depths, kDepth, rate);
    std::vector<int> kept;
    for (int i = 0; i < kFrames; ++i) {
      if (!colors.contains(i) && !depths.contains(i)) kept.push_back(i);
    }
    VideoClip source = open();
    const auto frames = readAll(source);
    ASSERT_EQ(frames.size(), kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      wrong += frames[i].color != frames[i].depth ? 1 : 0;
      EXPECT_EQ(frames[i].color, kept[i]);
      EXPECT_EQ(frames[i].index, static_cast<std::uint64_t>(kept[i]));
      EXPECT_NEAR(frames[i].time_s, kept[i] / source.info().fps, 1e-9);
    }
  }
  EXPECT_EQ(wrong, 0);
}

/// Times of frames that were not dropped, rounded to ms, with a jitter.
std::vector<double> drawTimes(std::mt19937& random, int frames, double fps, double jitter_s,
                              const std::set<int>& dropped) {
  std::normal_distribution<double> jitter(0.0, jitter_s);
  std::vector<double> times_s;
  for (int i = 0; i < frames; ++i) {
    const double time_s = 7.0 + i / fps + (i > 0 ? jitter(random) : 0.0);
    if (!dropped.contains(i)) times_s.push_back(std::round(1000.0 * time_s) / 1000.0);
  }
  return times_s;
}

TEST(FrameTimes, NoPairIsWrongWhateverFramesAreDroppedFromLongClips) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 0.3);
  for (int round = 0; round < 300; ++round) {
    constexpr int kFrames = 600;
    const double fps =
        std::array{15.0, 24.0, 29.97, 30.0, 60.0}[static_cast<std::size_t>(round % 5)];
    const auto no_color = draw(random, kFrames, share(random));
    const auto no_depth = draw(random, kFrames, share(random));
    const FrameTimes color = describeTimes(drawTimes(random, kFrames, fps, 0.001, no_color));
    const FrameTimes depth = describeTimes(drawTimes(random, kFrames, fps, 0.001, no_depth));
    ASSERT_TRUE(belongByTime(color, depth));
    EXPECT_NEAR(color.fps, fps, 0.005 * fps);
    EXPECT_NEAR(depth.fps, fps, 0.005 * fps);
    std::uint64_t without = 0;
    for (const int i : no_depth) without += no_color.contains(i) ? 0 : 1;
    EXPECT_EQ(findLone(color, depth).count, without);
    for (const double time_s : color.times_s) {
      const double nearest_s = nearestTime_s(depth.times_s, time_s);
      if (std::abs(nearest_s - time_s) > depth.tolerance_s()) continue;
      EXPECT_EQ(std::lround(nearest_s * fps), std::lround(time_s * fps));
    }
  }
}

TEST(FrameTimes, TimesThatSayNothingAreNotUsed) {
  EXPECT_FALSE(describeTimes({}).usable());
  EXPECT_FALSE(describeTimes({1.0}).usable());
  EXPECT_FALSE(describeTimes({1.0, 1.0, 1.0}).usable());
  EXPECT_FALSE(describeTimes({0.0, 2.0, 4.0}).usable()) << "less than 1 frame/s";
  EXPECT_FALSE(describeTimes({0.0, 0.001, 0.002}).usable()) << "more than 240 frames/s";
  EXPECT_FALSE(describeTimes({0.0, 0.04, 1e15}).usable());
  EXPECT_TRUE(describeTimes({0.0, 0.04}).usable());
}

}  // namespace
}  // namespace hapticast::server
