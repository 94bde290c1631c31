// SPDX-License-Identifier: MIT
// Pairs of video files as a source. Motion JPEG is written with OpenCV, the others with ffmpeg
// where it is there.
#include "server/source/video/video_clip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <vector>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class VideoPairFiles : public testing::Test {
 protected:
  /// Motion JPEG; frame i is evenly 40 + 8 i bright, times `tint`.
  [[nodiscard]] std::string video(const std::string& name, int frames, cv::Size size = {64, 48},
                                  const cv::Scalar& tint = {1.0, 1.0, 1.0},
                                  double fps = 30.0) const {
    std::string file = (folder / name).string();
    cv::VideoWriter writer(file, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps, size);
    EXPECT_TRUE(writer.isOpened());
    for (int i = 0; i < frames; ++i) writer.write(cv::Mat(size, CV_8UC3, tint * (40.0 + 8.0 * i)));
    return file;
  }
  /// Ten frames made by ffmpeg; false where it is not there.
  [[nodiscard]] bool ffmpeg(const std::string& arguments, const std::string& name) const {
    const std::string command = "ffmpeg -loglevel quiet -y -f lavfi " + arguments + " '" +
                                (folder / name).string() + "' >/dev/null 2>&1 </dev/null";
    return std::system(command.c_str()) == 0;
  }
  /// Ten frames of random depths of so many bits, written by ffmpeg with `-pix_fmt` and what
  /// follows; none where it is not there. Returns the depths as CV_32FC1.
  [[nodiscard]] std::vector<cv::Mat> depthFile(const std::string& format, const std::string& name,
                                               int bits) const {
    const std::string from = (folder / "depth.raw").string();
    std::ofstream raw(from, std::ios::binary);
    std::vector<cv::Mat> depths;
    cv::RNG random(7);
    for (int i = 0; i < 10; ++i) {
      cv::Mat depth(48, 64, CV_16UC1);
      random.fill(depth, cv::RNG::UNIFORM, 0, 1 << bits);
      raw.write(reinterpret_cast<const char*>(depth.data), 48L * 64L * 2L);
      depths.emplace_back();
      depth.convertTo(depths.back(), CV_32F);
    }
    raw.close();
    const std::string same = bits == 16 ? "gray16le" : "gray" + std::to_string(bits) + "le";
    const std::string command = "ffmpeg -loglevel quiet -y -f rawvideo -s 64x48 -r 30 -pix_fmt " +
                                same + " -i '" + from + "' -pix_fmt " + format + " '" +
                                (folder / name).string() + "' >/dev/null 2>&1 </dev/null";
    return std::system(command.c_str()) == 0 ? depths : std::vector<cv::Mat>();
  }
  [[nodiscard]] std::string readAll(const std::string& name) const {
    std::ifstream in(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  [[nodiscard]] static std::string openError(const std::string& color, const std::string& depth) {
    return errorOf([&] { VideoClip(color, depth, 0.0); });
  }
  SourceFolder folder;
};

TEST_F(VideoPairFiles, ReadsBothTogether) {
  VideoClip source(video("c.avi", 8), video("d.avi", 8), 0.0);
  EXPECT_EQ(source.info().width_px, 64);
  EXPECT_EQ(source.info().height_px, 48);
  EXPECT_EQ(source.info().fps, 30.0);
  EXPECT_EQ(source.info().frame_count, 8U);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kHeight);
  std::vector<cv::Mat> kept;
  for (int i = 0; i < 8; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_EQ(frame->depth.type(), CV_32FC1);
    EXPECT_NEAR(frame->depth.at<float>(20, 30), 40.0F + 8.0F * static_cast<float>(i), 3.0F);
    kept.push_back(frame->color);
  }
  EXPECT_FALSE(source.read());
  EXPECT_NEAR(kept[2].at<cv::Vec3b>(20, 30)[0], 56, 3) << "a frame keeps its own pixels";
  source.rewind();
  EXPECT_TRUE(source.skip());
  const auto frame = source.read();
  EXPECT_EQ(frame->index, 1U);
  EXPECT_EQ(frame->epoch, 1U);
  EXPECT_NEAR(frame->depth.at<float>(20, 30), 48.0F, 3.0F);
  EXPECT_EQ(VideoClip(video("c.avi", 8), video("d.avi", 8), 12.0).info().fps, 12.0);
}

TEST_F(VideoPairFiles, EndsWithTheShorterAndReportsSoOnce) {
  VideoClip source(video("c.avi", 8), video("d.avi", 6), 0.0);
  EXPECT_EQ(source.info().frame_count, 6U);
  const LogLines log;
  int frames = 0;
  while (source.read()) ++frames;
  EXPECT_EQ(frames, 6);
  EXPECT_FALSE(source.read());
  source.rewind();
  while (source.read()) {
  }
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("d.avi: ends after 6 frames"), HasSubstr("c.avi")));
}

TEST_F(VideoPairFiles, AFileThatVanishesOrIsAnotherEndsTheNextRoundInOneLine) {
  const std::string color = video("c.avi", 4);
  VideoClip source(color, video("d.avi", 4), 0.0);
  while (source.read()) {
  }
  const LogLines log;
  (void)video("d.avi", 4, {32, 24});
  source.rewind();
  EXPECT_THAT(errorOf([&] { (void)source.read(); }),
              AllOf(HasSubstr("d.avi: frame 0"), HasSubstr("64x48")));
  (void)video("d.avi", 0);
  EXPECT_THAT(errorOf([&] {
                source.rewind();
                (void)source.read();
              }),
              HasSubstr("d.avi: "));
  std::filesystem::remove(folder / "d.avi");
  EXPECT_THAT(errorOf([&] { source.rewind(); }), HasSubstr("d.avi: no such file"));
  EXPECT_EQ(log.count(), 0) << log.text();
}

TEST_F(VideoPairFiles, VeryDifferentCountsAreRefused) {
  EXPECT_THAT(openError(video("c.avi", 20), video("d.avi", 10)),
              HasSubstr("d.avi: has 10 frames, but the colour video has 20"));
}

TEST_F(VideoPairFiles, DifferentAspectsAreRefused) {
  EXPECT_THAT(openError(video("c.avi", 3), video("d.avi", 3, {32, 32})),
              HasSubstr("d.avi: is 32x32, but the colour video is 64x48"));
}

TEST_F(VideoPairFiles, SmallerDepthOfTheSameAspectIsScaled) {
  const LogLines log;
  VideoClip source(video("c.avi", 3), video("d.avi", 3, {32, 24}), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("d.avi: depth of 32 x 24 is scaled to 64 x 48"));
  const auto frame = source.read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.size(), cv::Size(64, 48));
  EXPECT_NEAR(frame->depth.at<float>(47, 63), 40.0F, 3.0F);
  while (source.read()) {
  }
  EXPECT_EQ(log.count(), 1) << log.text();
}

TEST_F(VideoPairFiles, DepthInColoursIsRefused) {
  EXPECT_THAT(openError(video("c.avi", 3), video("d.avi", 3, {64, 48}, {4.0, 1.0, 0.1})),
              HasSubstr("d.avi: shows depth as colours"));
}

TEST_F(VideoPairFiles, ColourInASmallPartOfDepthIsRefused) {
  const std::string depth = (folder / "d.avi").string();
  cv::VideoWriter writer(depth, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 30.0, {160, 120});
  cv::Mat picture = cv::Mat::zeros(120, 160, CV_8UC3);  // a background that was removed
  picture(cv::Rect(64, 48, 32, 24)).setTo(cv::Scalar(110, 140, 210));
  for (int i = 0; i < 3; ++i) writer.write(picture);
  writer.release();
  EXPECT_THAT(openError(video("c.avi", 3, {160, 120}), depth),
              HasSubstr("d.avi: shows depth as colours"));
}

TEST_F(VideoPairFiles, OneFileForBothIsRefused) {
  const std::string color = video("c.avi", 3);
  EXPECT_THAT(openError(color, (folder / "." / "c.avi").string()),
              HasSubstr("c.avi: is the colour video and the depth video"));
}

TEST_F(VideoPairFiles, AFolderInThePairIsReportedAsOne) {
  EXPECT_THAT(openError(video("c.avi", 3), folder.string()), HasSubstr(": is a folder, but"));
}

TEST_F(VideoPairFiles, DifferentRatesAreReportedOnce) {
  const LogLines log;
  const std::string color = video("c.avi", 8, {64, 48}, {1.0, 1.0, 1.0}, 24.0);
  VideoClip source(color, video("d.avi", 8), 0.0);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("d.avi: has 30 frames/s, but the colour video has 24"),
                                HasSubstr("pairs frames by number"), HasSubstr("fps=24")));
  source.rewind();
  EXPECT_EQ(log.count(), 1);
  EXPECT_EQ(source.info().fps, 24.0);
  VideoClip same(video("c.avi", 8, {64, 48}, {1.0, 1.0, 1.0}, 29.97), video("d.avi", 8), 0.0);
  EXPECT_EQ(log.count(), 1) << "29.97 is 30";
}

TEST_F(VideoPairFiles, TooLargeIsRefused) {
  EXPECT_THAT(openError(video("c.avi", 1, {8208, 64}), video("d.avi", 1)),
              HasSubstr("c.avi: is 8208x64, larger than 8192 px a side"));
}

TEST_F(VideoPairFiles, MissingAndUnreadableFilesAreRefused) {
  const std::string good = video("c.avi", 3);
  EXPECT_THAT(openError(good, good + "x"), HasSubstr("c.avix: no such file"));
  EXPECT_THAT(openError(good + "x", good), HasSubstr("c.avix: no such file"));
  folder.write("text.mp4", std::string(5000, 'x'));
  EXPECT_THAT(openError(good, (folder / "text.mp4").string()),
              HasSubstr("text.mp4: holds no video that can be read"));
  folder.write("empty.mp4", std::string());
  EXPECT_THAT(openError(good, (folder / "empty.mp4").string()),
              HasSubstr("empty.mp4: holds no video"));
}

TEST_F(VideoPairFiles, AVideoWithoutFramesIsRefused) {
  const std::string good = video("c.avi", 3);
  if (!ffmpeg("-i color=size=64x48:rate=25 -frames:v 0 -c:v mjpeg", "zero.mkv")) {
    GTEST_SKIP() << "needs ffmpeg";
  }
  EXPECT_THAT(openError(good, (folder / "zero.mkv").string()), HasSubstr("zero.mkv: h"));
}

TEST_F(VideoPairFiles, SoundWithoutPictureIsRefused) {
  const std::string good = video("c.avi", 3);
  if (!ffmpeg("-i sine=duration=0.2", "sound.wav")) GTEST_SKIP() << "needs ffmpeg";
  EXPECT_THAT(openError(good, (folder / "sound.wav").string()),
              HasSubstr("sound.wav: holds no video that can be read"));
}

TEST_F(VideoPairFiles, DepthOfMoreThanEightBitsIsMmToTheBit) {
  const std::string good = video("c.avi", 10);
  struct Kind {
    std::string format;
    std::string name;
    int bits;
  };
  const std::vector<Kind> kinds{
      {"gray16le -c:v ffv1", "le.mkv", 16}, {"gray16be -c:v png", "png.mkv", 16},
      {"gray16be -c:v png", "png.mov", 16}, {"gray16be -c:v rawvideo -tag:v b16g", "raw.mov", 16},
      {"gray12le -c:v ffv1", "12.mkv", 12}, {"gray10le -c:v ffv1", "10.mkv", 10}};
  for (const auto& [format, name, bits] : kinds) {
    SCOPED_TRACE(name);
    const std::vector<cv::Mat> depths = depthFile(format, name, bits);
    if (depths.empty()) GTEST_SKIP() << "needs ffmpeg";
    VideoClip source(good, (folder / name).string(), 0.0);
    EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
    for (const cv::Mat& depth : depths) {
      const auto frame = source.read();
      ASSERT_TRUE(frame);
      ASSERT_EQ(frame->depth.type(), CV_32FC1);
      EXPECT_EQ(cv::countNonZero(frame->depth != depth), 0);
    }
    EXPECT_FALSE(source.read());
  }
}

TEST_F(VideoPairFiles, ColouredDepthOfMoreThanEightBitsIsRefused) {
  const std::string good = video("c.avi", 10);
  for (const std::string format : {"yuv420p10le", "yuv444p16le"}) {
    const std::string name = format + ".mkv";
    if (!ffmpeg("-i testsrc=size=64x48:rate=25:duration=0.4 -c:v ffv1 -pix_fmt " + format, name)) {
      GTEST_SKIP() << "needs ffmpeg with FFV1";
    }
    EXPECT_THAT(openError(good, (folder / name).string()),
                AllOf(HasSubstr(name + ": depth video with "), HasSubstr("is " + format),
                      HasSubstr("gray16le -c:v ffv1")));
  }
}

TEST_F(VideoPairFiles, ADamagedFrameOfPngDepthIsLeftOut) {
  const std::string good = video("c.avi", 10);
  if (depthFile("gray16be -c:v png", "d.mkv", 16).empty()) GTEST_SKIP() << "needs ffmpeg";
  std::string bytes = readAll("d.mkv");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  folder.write("d.mkv", bytes);
  VideoClip source(good, (folder / "d.mkv").string(), 0.0);
  const LogLines log;
  std::vector<std::uint64_t> read;
  while (const auto frame = source.read()) read.push_back(frame->index);
  EXPECT_EQ(read.size(), 9U);
  EXPECT_EQ(read.back(), 9U) << "later frames keep their numbers";
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), AllOf(HasSubstr("d.mkv: frame "), HasSubstr("cannot be decoded")));
}

TEST_F(VideoPairFiles, PicturesAreThoseOfOpenCv) {
  // Each kind of file that people had before: the same pixels as through OpenCV's reader.
  const std::vector<std::array<std::string, 2>> kinds{
      {"-c:v libx264 -pix_fmt yuv420p", "h264.mp4"},
      {"-c:v libx264 -pix_fmt yuvj420p", "full.mp4"},
      {"-c:v libx264 -pix_fmt yuv420p -bf 2", "b.mkv"},
      {"-c:v mpeg4", "mpeg4.avi"},
      {"-c:v mjpeg", "mjpeg.mov"},
      {"-c:v libvpx -b:v 500k", "vp8.webm"},
      {"-c:v png -pix_fmt rgb24", "png.mov"},
      {"-c:v ffv1 -pix_fmt gray", "grey.mkv"}};
  for (const auto& [arguments, name] : kinds) {
    SCOPED_TRACE(name);
    if (!ffmpeg("-i testsrc=size=96x64:rate=25:duration=0.4 " + arguments, name))
      GTEST_SKIP() << "needs ffmpeg";
    const std::string file = (folder / name).string();
    VideoFile video_file(file);
    video_file.start(0);
    cv::VideoCapture reference(file, cv::CAP_FFMPEG);
    const VideoTrack& track = video_file.tracks().front();
    EXPECT_EQ(track.width_px, reference.get(cv::CAP_PROP_FRAME_WIDTH));
    EXPECT_EQ(track.height_px, reference.get(cv::CAP_PROP_FRAME_HEIGHT));
    EXPECT_EQ(track.fps, reference.get(cv::CAP_PROP_FPS));
    EXPECT_EQ(static_cast<double>(track.frame_count), reference.get(cv::CAP_PROP_FRAME_COUNT));
    int frames = 0;
    for (cv::Mat wanted; reference.read(wanted); ++frames, wanted = cv::Mat()) {
      ASSERT_TRUE(video_file.grab(0));
      const cv::Mat picture = video_file.retrieveColor(0);
      ASSERT_EQ(picture.size(), wanted.size());
      EXPECT_LE(cv::norm(picture, wanted, cv::NORM_INF), 2.0) << "frame " << frames;
    }
    EXPECT_EQ(frames, 10);
    EXPECT_FALSE(video_file.grab(0));
  }
}

TEST_F(VideoPairFiles, PicturesOfPhonesAreTurnedAsPlayersTurnThem) {
  // OpenCV 4.6 turned them the other way: portrait pictures stood on their heads.
  if (!ffmpeg("-i testsrc=size=96x64:rate=25:duration=0.4 -c:v libx264 -pix_fmt yuv420p", "a.mp4"))
    GTEST_SKIP() << "needs ffmpeg";
  for (const int turn_deg : {90, 180, 270}) {
    const char* const run = "ffmpeg -loglevel quiet -y </dev/null ";
    std::ostringstream copy;  // by FFmpeg 6 and later, or by 5.1
    copy << "cd '" << folder.string() << "' && { " << run << "-display_rotation -" << turn_deg
         << " -i a.mp4 -c copy turned.mp4 || " << run
         << "-i a.mp4 -c copy -metadata:s:v rotate=" << turn_deg << " turned.mp4; } && " << run
         << "-i turned.mp4 -frames:v 1 turned.png";
    ASSERT_EQ(std::system(copy.str().c_str()), 0);
    VideoFile turned((folder / "turned.mp4").string());
    EXPECT_EQ(turned.tracks().front().width_px, turn_deg == 180 ? 96 : 64);
    turned.start(0);
    ASSERT_TRUE(turned.grab(0));
    const cv::Mat shown = cv::imread((folder / "turned.png").string());
    const cv::Mat picture = turned.retrieveColor(0);
    ASSERT_EQ(picture.size(), shown.size());
    EXPECT_LE(cv::norm(picture, shown, cv::NORM_INF), 3.0) << turn_deg;
  }
}

TEST_F(VideoPairFiles, EightBitGreyIsReadExactly) {
  const std::string good = video("c.avi", 10);
  // Frame n is evenly 10 n: lossless, full range.
  if (!ffmpeg(
          "-i \"color=black:size=64x48:rate=25:duration=0.4,format=gray,geq=lum=10*N\" -c:v ffv1",
          "g.mkv")) {
    GTEST_SKIP() << "needs ffmpeg with FFV1";
  }
  VideoClip source(good, (folder / "g.mkv").string(), 0.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(source.read()->depth.at<float>(5, 5), 10.0F * static_cast<float>(i));
  }
}

}  // namespace
}  // namespace hapticast::server
