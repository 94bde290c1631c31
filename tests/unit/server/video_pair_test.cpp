// SPDX-License-Identifier: MIT
// Pairs of video files as a source. 8-bit files are written with OpenCV, the others with ffmpeg
// where it is there.
#include "server/source/video_pair.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/videoio.hpp>

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
  [[nodiscard]] static std::string openError(const std::string& color, const std::string& depth) {
    return errorOf([&] { VideoPair(color, depth, 0.0); });
  }
  SourceFolder folder;
};

TEST_F(VideoPairFiles, ReadsBothTogether) {
  VideoPair source(video("c.avi", 8), video("d.avi", 8), 0.0);
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
  EXPECT_EQ(VideoPair(video("c.avi", 8), video("d.avi", 8), 12.0).info().fps, 12.0);
}

TEST_F(VideoPairFiles, EndsWithTheShorterAndSaysSoOnce) {
  VideoPair source(video("c.avi", 8), video("d.avi", 6), 0.0);
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
  VideoPair source(color, video("d.avi", 4), 0.0);
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

TEST_F(VideoPairFiles, DifferentSizesAreRefused) {
  EXPECT_THAT(openError(video("c.avi", 3), video("d.avi", 3, {32, 24})),
              HasSubstr("d.avi: is 32x24, but the colour video is 64x48"));
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

TEST_F(VideoPairFiles, AFolderInThePairIsToldAsOne) {
  EXPECT_THAT(openError(video("c.avi", 3), folder.string()), HasSubstr(": is a folder, but"));
}

TEST_F(VideoPairFiles, DifferentRatesAreToldOnce) {
  const LogLines log;
  const std::string color = video("c.avi", 8, {64, 48}, {1.0, 1.0, 1.0}, 24.0);
  VideoPair source(color, video("d.avi", 8), 0.0);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("d.avi: has 30 frames/s, but the colour video has 24"),
                                HasSubstr("pairs frames by number"), HasSubstr("fps=24")));
  source.rewind();
  EXPECT_EQ(log.count(), 1);
  EXPECT_EQ(source.info().fps, 24.0);
  VideoPair same(video("c.avi", 8, {64, 48}, {1.0, 1.0, 1.0}, 29.97), video("d.avi", 8), 0.0);
  EXPECT_EQ(log.count(), 1) << "29.97 is 30";
}

TEST_F(VideoPairFiles, TooLargeIsRefused) {
  EXPECT_THAT(openError(video("c.avi", 1, {1936, 64}), video("d.avi", 1)),
              HasSubstr("c.avi: is 1936x64; allowed is up to 1920x1080"));
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

TEST_F(VideoPairFiles, DepthOfMoreThanEightBitsIsRefused) {
  const std::string good = video("c.avi", 10);
  for (const std::string format :
       {"gray16le", "gray10le", "gray12le", "yuv420p10le", "yuv444p16le"}) {
    const std::string name = format + ".mkv";
    if (!ffmpeg("-i testsrc=size=64x48:rate=25:duration=0.4 -c:v ffv1 -pix_fmt " + format, name)) {
      GTEST_SKIP() << "needs ffmpeg with FFV1";
    }
    EXPECT_THAT(openError(good, (folder / name).string()),
                AllOf(HasSubstr(name + ": depth video with more than 8 bits"),
                      HasSubstr("16-bit depth/ PNG")));
  }
  ASSERT_TRUE(
      ffmpeg("-i testsrc=size=64x48:rate=25:duration=0.4 -c:v png -pix_fmt gray16be", "be.mkv"));
  EXPECT_THAT(openError(good, (folder / "be.mkv").string()), HasSubstr("more than 8 bits"));
}

TEST_F(VideoPairFiles, EightBitGreyIsReadExactly) {
  const std::string good = video("c.avi", 10);
  // Frame n is evenly 10 n: lossless, full range.
  if (!ffmpeg(
          "-i \"color=black:size=64x48:rate=25:duration=0.4,format=gray,geq=lum=10*N\" -c:v ffv1",
          "g.mkv")) {
    GTEST_SKIP() << "needs ffmpeg with FFV1";
  }
  VideoPair source(good, (folder / "g.mkv").string(), 0.0);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(source.read()->depth.at<float>(5, 5), 10.0F * static_cast<float>(i));
  }
}

TEST(VideoPair, KnowsEightBitFormats) {
  const auto tag = [](char a, char b, char c, char d) {
    return static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b) << 8U |
           static_cast<std::uint32_t>(c) << 16U | static_cast<std::uint32_t>(d) << 24U;
  };
  EXPECT_TRUE(isEightBitFormat(tag('Y', '8', '0', '0')));
  EXPECT_TRUE(isEightBitFormat(tag('I', '4', '2', '0')));
  EXPECT_TRUE(isEightBitFormat(tag('R', 'G', 'B', 24)));
  EXPECT_FALSE(isEightBitFormat(tag('Y', '1', 0, 16)));
  EXPECT_FALSE(isEightBitFormat(tag(16, 0, '1', 'Y')));
  EXPECT_FALSE(isEightBitFormat(tag('R', 'G', 'B', 48)));
  EXPECT_FALSE(isEightBitFormat(tag('R', 'G', 'B', 15))) << "what FFmpeg says when it has no tag";
  EXPECT_FALSE(isEightBitFormat(0));
}

}  // namespace
}  // namespace hapticast::server
