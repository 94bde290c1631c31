// SPDX-License-Identifier: MIT
// One video file with colour and depth: as two tracks, or as halves of one picture.
#include "server/source/video/video_clip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "server/source/picture/depth_code.hpp"
#include "tests/unit/server/single_video_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Returns the colour that Record3D writes for a depth.
cv::Vec3b hueOf(double depth_mm) {
  const cv::Mat hsv(1, 1, CV_32FC3, cv::Scalar(360.0 * depth_mm / 3000.0, 1.0, 1.0));
  cv::Mat bgr;
  cv::cvtColor(hsv, bgr, cv::COLOR_HSV2BGR);
  cv::Mat levels;
  bgr.convertTo(levels, CV_8U, 255.0);
  return levels.at<cv::Vec3b>(0, 0);
}

TEST_F(SingleVideoFiles, TwoTracksAreColourAndDepthToTheBit) {
  ffmpeg(rawColor() + rawDepth() + kCopyTwo + "two.mkv");
  ffmpeg("-i two.mkv -map 0:1 -map 0:0 -c copy other.mkv");
  for (const char* name : {"two.mkv", "other.mkv"}) {
    SCOPED_TRACE(name);
    const auto source = openSource(at(name), 0.0);
    EXPECT_EQ(source->info().depth_kind, DepthKind::kMetric);
    // From the duration of the whole file.
    EXPECT_NEAR(static_cast<double>(source->info().frame_count.value_or(0)), 10.0, 2.0);
    EXPECT_EQ(source->info().fps, 30.0);
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < kVideoFrames; ++i) {
        const auto frame = source->read();
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
        EXPECT_EQ(frame->epoch, static_cast<std::uint32_t>(round));
        cv::Mat wanted;
        drawnDepth(i, {64, 48}).convertTo(wanted, CV_32F);
        EXPECT_EQ(cv::countNonZero(frame->depth != wanted), 0);
        EXPECT_TRUE(isColorCoded(frame->color));
      }
      EXPECT_FALSE(source->read());
      source->rewind();
    }
  }
}

TEST_F(SingleVideoFiles, ATrackOfTheNameDepthIsDepth) {
  const std::string tracks =
      "-map 0 -map 1 -c:v libx264 -pix_fmt yuv420p -metadata:s:v:0 title=Depth ";
  ffmpeg("-f lavfi -i color=gray:size=64x48:rate=30:duration=0.333 " + rawColor() + tracks +
         "named.mkv");
  const auto source = openSource(at("named.mkv"), 0.0);
  EXPECT_EQ(source->info().depth_kind, DepthKind::kHeight);
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_NEAR(frame->depth.at<float>(20, 20), 128.0F, 3.0F);
  EXPECT_TRUE(isColorCoded(frame->color));
  ffmpeg("-i named.mkv -map 0 -c copy -metadata:s:v:0 title= unnamed.mkv");
  EXPECT_THAT(openError("unnamed.mkv"),
              AllOf(HasSubstr("has 2 video tracks"), HasSubstr("title=depth")));
}

TEST_F(SingleVideoFiles, TimesPairFramesOfOtherRates) {
  ffmpeg(rawColor() + rawDepth({64, 48}, 15) + kCopyTwo + "rates.mkv");
  const auto source = openSource(at("rates.mkv"), 0.0);
  const LogLines log;
  for (int i = 0; i < kVideoFrames; ++i) {
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    // An odd frame lies in the middle of two depths.
    const float depth_mm = frame->depth.at<float>(5, 5);
    const int before = i / 2;
    const int after = (i + 1) / 2;
    EXPECT_GE(depth_mm, 500.0F + 100.0F * static_cast<float>(before));
    EXPECT_LE(depth_mm, 500.0F + 100.0F * static_cast<float>(after));
  }
  EXPECT_EQ(log.count(), 0) << log.text();
}

TEST_F(SingleVideoFiles, FramesWithoutDepthAreLeftOut) {
  ffmpeg(rawColor() + rawDepth() + kCopyTwo +
         "-enc_time_base:v:1 1:1000 -bsf:v:1 setts=pts=PTS+100:dts=DTS+100 late.mkv");
  const auto source = openSource(at("late.mkv"), 0.0);
  const LogLines log;
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->index, 3U);
  EXPECT_EQ(frame->depth.at<float>(5, 5), 500.0F);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("late.mkv: frame 0 has no depth at its time"));
}

TEST_F(SingleVideoFiles, TimesThatRunBackLeaveFramesOut) {
  // A factor, because FFmpeg 5.1 counts PTS in ms and 7.1 in frames.
  ffmpeg(rawColor() + rawDepth() +
         "-map 0 -map 1 -c:v:0 mjpeg -c:v:1 ffv1 "
         "-bsf:v:0 \"setts=pts='if(eq(N,4),PTS*1.75,PTS)':dts=DTS\" jump.mkv");
  const auto source = openSource(at("jump.mkv"), 0.0);
  const LogLines log;
  int frames = 0;
  while (source->read()) ++frames;
  EXPECT_GE(frames, 5);
  EXPECT_LT(frames, kVideoFrames);
  EXPECT_THAT(log.text(), HasSubstr("jump.mkv: frame 5 has a time stamp that runs back"));
}

TEST_F(SingleVideoFiles, SmallerDepthIsScaledAndOtherAspectsAreRefused) {
  ffmpeg(rawColor() + rawDepth({32, 24}) + kCopyTwo + "small.mkv");
  const LogLines log;
  const auto source = openSource(at("small.mkv"), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("depth of 32 x 24 is scaled to 64 x 48"));
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.size(), cv::Size(64, 48));
  EXPECT_EQ(cv::countNonZero(frame->depth.colRange(0, 28) != 500.0F), 0);
  ffmpeg(rawColor() + rawDepth({40, 40}) + kCopyTwo + "square.mkv");
  EXPECT_THAT(openError("square.mkv"),
              HasSubstr("square.mkv: is 40x40, but the colour video is 64x48"));
}

TEST_F(SingleVideoFiles, RecordingsOfAKinectAreReportedAsUnaligned) {
  // Colour, depth and infrared, both grey with 16 bits, raw.
  ffmpeg(
      rawColor() + rawDepth() + "-f lavfi -i nullsrc=size=64x48:rate=30:duration=0.333 " +
      "-map 0 -map 2 -map 1 -c:v:0 mjpeg -pix_fmt:v:0 yuvj420p -c:v:1 ffv1 -pix_fmt:v:1 gray16le "
      "-c:v:2 ffv1 -pix_fmt:v:2 gray16le -metadata:s:v:2 K4A_DEPTH_TRACK=2 k4a.mkv");
  const LogLines log;
  const auto source = openSource(at("k4a.mkv"), 0.0);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), AllOf(HasSubstr("k4a.mkv"), HasSubstr("not aligned")));
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.at<float>(5, 5), 500.0F);
}

TEST_F(SingleVideoFiles, RawDepthInTheFormatOfAKinectIsExact) {
  // As the recorder writes it: big-endian values, with b16g in a BITMAPINFOHEADER. ffmpeg writes
  // the header with a zero there.
  ffmpeg(rawColor() + rawDepth() +
         "-map 0 -map 1 -c:v:0 mjpeg -pix_fmt:v:0 yuvj420p -c:v:1 rawvideo " +
         "-pix_fmt:v:1 gray16be -allow_raw_vfw 1 -metadata:s:v:1 K4A_DEPTH_TRACK=2 k4a.mkv");
  std::ifstream in(folder / "k4a.mkv", std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  // Its size, width, negative height, planes, bits and format.
  const std::string header("\x28\0\0\0\x40\0\0\0\xD0\xFF\xFF\xFF\x01\0\x10\0\0\0\0\0", 20);
  const std::size_t place = bytes.find(header);
  ASSERT_NE(place, std::string::npos);
  const std::string recorder("\x28\0\0\0\x40\0\0\0\x30\0\0\0\x01\0\x10\0b16g", 20);
  bytes.replace(place, header.size(), recorder);
  const auto source = openSource(folder.write("b16g.mkv", bytes), 0.0);
  EXPECT_EQ(source->info().depth_kind, DepthKind::kMetric);
  for (int i = 0; i < kVideoFrames; ++i) {
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    cv::Mat wanted;
    drawnDepth(i, {64, 48}).convertTo(wanted, CV_32F);
    EXPECT_EQ(cv::countNonZero(frame->depth != wanted), 0);
  }
}

TEST_F(SingleVideoFiles, HalvesOfGreyDepth) {
  // Colour in one half; in the other, frame i is evenly 20 i bright.
  const auto draw = [](bool beside) {
    return [beside](int i) {
      const cv::Mat color(48, 64, CV_8UC3, cv::Scalar(40, 90, 200));
      const cv::Mat grey(48, 64, CV_8UC3, cv::Scalar::all(20.0 * i));
      cv::Mat picture;
      if (beside)
        cv::hconcat(color, grey, picture);
      else
        cv::vconcat(color, grey, picture);
      return picture;
    };
  };
  ffmpeg(raw("b.raw", "bgr24", {128, 48}, draw(true)) + "-c:v ffv1 -pix_fmt bgr0 beside.mkv");
  ffmpeg(raw("b.raw", "bgr24", {64, 96}, draw(false)) + "-c:v ffv1 -pix_fmt bgr0 below.mkv");
  const auto expectDepth = [&](const char* name, const VideoLayout& layout, float first,
                               float step) {
    SCOPED_TRACE(name);
    const auto source = openSource(at(name), 0.0, false, layout);
    EXPECT_EQ(source->info().width_px, 64);
    EXPECT_EQ(source->info().height_px, 48);
    for (int i = 0; i < kVideoFrames; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->depth.at<float>(30, 30), first + step * static_cast<float>(i));
      EXPECT_EQ(frame->color.at<cv::Vec3b>(30, 30), cv::Vec3b(40, 90, 200));
    }
    EXPECT_FALSE(source->read());
  };
  expectDepth("beside.mkv", {Layout::kSideBySide, DepthCode::kGrey}, 0.0F, 20.0F);
  expectDepth("beside.mkv", {Layout::kSideBySide, DepthCode::kInverse}, 255.0F, -20.0F);
  expectDepth("below.mkv", {Layout::kTopBottom, DepthCode::kGrey}, 0.0F, 20.0F);
  EXPECT_THAT(openError("beside.mkv"), AllOf(HasSubstr("beside.mkv: has one video track"),
                                             HasSubstr("side by side with grey depth on the right"),
                                             HasSubstr("confirm with --layout side-by-side")));
  EXPECT_THAT(openError("below.mkv"), HasSubstr("confirm with --layout top-bottom"));
}

TEST_F(SingleVideoFiles, HueOfRecord3d) {
  // Left: a plane from 150 to 2750 mm, with black where nothing was measured. Right: colour.
  const auto depthAt = [](int u) { return 150.0 + 2600.0 * u / 127.0; };
  const auto draw = [&](int) {
    cv::Mat picture(96, 256, CV_8UC3, cv::Scalar(120, 130, 150));
    for (int u = 0; u < 128; ++u) picture.col(u).rowRange(0, 80).setTo(hueOf(depthAt(u)));
    picture(cv::Rect(0, 80, 128, 16)).setTo(0);
    return picture;
  };
  const std::string from = raw("hue.raw", "bgr24", {256, 96}, draw);
  ffmpeg(from + "-c:v ffv1 -pix_fmt bgr0 hue.mkv");
  ffmpeg(from + "-c:v libx264 -pix_fmt yuv420p -crf 18 hue.mp4");
  const VideoLayout record3d{Layout::kSideBySide, DepthCode::kHue};
  // The 1530 hues of 8 bits are 1.96 mm apart. A lossy codec has larger errors.
  for (const auto& [name, largest_mm] : {std::pair{"hue.mkv", 1.0}, std::pair{"hue.mp4", 40.0}}) {
    SCOPED_TRACE(name);
    const auto source = openSource(at(name), 0.0, false, record3d);
    EXPECT_EQ(source->info().depth_kind, DepthKind::kMetric);
    EXPECT_EQ(source->info().width_px, 128);
    const auto frame = source->read();
    ASSERT_TRUE(frame);
    EXPECT_NEAR(frame->color.at<cv::Vec3b>(40, 100)[0], 120, 8) << "colour is on the right";
    double error_mm = 0.0;
    for (int u = 2; u < 126; ++u)
      error_mm = std::max(error_mm, std::abs(frame->depth.at<float>(40, u) - depthAt(u)));
    EXPECT_LE(error_mm, largest_mm);
    RecordProperty(std::string(name) + "_error_mm", std::to_string(error_mm));
    EXPECT_EQ(cv::countNonZero(frame->depth.rowRange(84, 96)), 0) << "black is not measured";
    EXPECT_THAT(openError(name), AllOf(HasSubstr("hue-coded depth on the left"),
                                       HasSubstr("--layout side-by-side --depth-code hue")));
  }
}

TEST_F(SingleVideoFiles, DepthOutsideTheRangeOfRecord3dIsNotMeasured) {
  cv::Mat hues(1, 4, CV_8UC3);
  hues.at<cv::Vec3b>(0, 0) = hueOf(90.0);
  hues.at<cv::Vec3b>(0, 1) = hueOf(120.0);
  hues.at<cv::Vec3b>(0, 2) = hueOf(2780.0);
  hues.at<cv::Vec3b>(0, 3) = hueOf(2810.0);
  const cv::Mat depth = decodeDepth(hues, DepthCode::kHue);
  EXPECT_EQ(depth.at<float>(0, 0), 0.0F);
  EXPECT_NEAR(depth.at<float>(0, 1), 120.0F, 1.0F);
  EXPECT_NEAR(depth.at<float>(0, 2), 2780.0F, 1.0F);
  EXPECT_EQ(depth.at<float>(0, 3), 0.0F);
}

}  // namespace
}  // namespace hapticast::server
