// SPDX-License-Identifier: MIT
// Single videos that are refused, damaged or cut off.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "tests/unit/server/single_video_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

using DamagedVideoFiles = SingleVideoFiles;

TEST_F(DamagedVideoFiles, AColourVideoAloneIsRefusedWithoutAGuess) {
  ffmpeg("-f lavfi -i mandelbrot=size=64x48:rate=30 -frames:v 3 -c:v mjpeg c.avi");
  EXPECT_THAT(openError("c.avi"), AllOf(HasSubstr("c.avi: is a single file with one video track"),
                                        HasSubstr("COLOR,DEPTH")));
}

TEST_F(DamagedVideoFiles, TooLargePicturesAreRefusedBeforeTheyAreDecoded) {
  ffmpeg("-f lavfi -i color=size=16400x64 -frames:v 1 -c:v mjpeg wide.avi");
  EXPECT_THAT(openError("wide.avi", {Layout::kSideBySide, DepthCode::kGrey}),
              HasSubstr("wide.avi: is 8200x64, larger than 8192 px a side"));
  ffmpeg("-f lavfi -i color=size=12288x6144 -frames:v 1 -c:v mjpeg large.avi");
  EXPECT_THAT(
      openError("large.avi", {Layout::kSideBySide, DepthCode::kGrey}),
      HasSubstr("large.avi: has pictures that cannot be decoded or are larger than 8192x4320"));
}

TEST_F(DamagedVideoFiles, PlaylistsAndFilesOfManyTracksAreRefused) {
  ffmpeg("-f lavfi -i color=size=32x32:duration=1 -c:v libx264 -f hls list.m3u8");
  EXPECT_THAT(openError("list.m3u8"), HasSubstr("list.m3u8: "));
  std::string maps;
  for (int i = 0; i < 17; ++i) maps += "-map 0 ";
  ffmpeg("-f lavfi -i color=size=32x32:duration=0.2 " + maps + "-c:v ffv1 many.mkv");
  EXPECT_THAT(openError("many.mkv"), HasSubstr("many.mkv: has 17 tracks; allowed are 16"));
}

TEST_F(DamagedVideoFiles, FlagsOfVideosAreRefusedForOtherSources) {
  const VideoLayout beside{Layout::kSideBySide, DepthCode::kGrey};
  const VideoLayout hue{Layout::kSeparate, DepthCode::kHue};
  for (const std::string& spec : {std::string("synthetic:still"), folder.string()}) {
    EXPECT_THAT(errorOf([&] { (void)openSource(spec, 0.0, false, beside); }),
                HasSubstr("only a single video file has a --layout"));
    EXPECT_THAT(errorOf([&] { (void)openSource(spec, 0.0, false, hue); }),
                HasSubstr("--depth-code (hue: only videos"));
  }
  EXPECT_THAT(errorOf([&] { (void)openSource("a.mp4,b.mp4", 0.0, false, beside); }),
              HasSubstr("only a single video file has a --layout"));
}

TEST_F(DamagedVideoFiles, DamagedFilesPlayTheirCompleteFramesOrEndInOneSentence) {
  ffmpeg(rawColor() + rawDepth() + kCopyTwo + "two.mkv");
  ffmpeg("-i two.mkv -map 0 -c:v:0 copy -c:v:1 png -pix_fmt:v:1 gray16be two.mov");
  ffmpeg("-i two.mkv -map 0:0 -c copy -movflags +faststart beside.mp4");
  ffmpeg("-i two.mkv -map 0:0 -c:v mjpeg beside.avi");
  ffmpeg("-i two.mkv -map 0:0 -c copy beside.ts");
  ffmpeg("-i two.mkv -map 0:0 -c:v libvpx beside.webm");
  cv::RNG random(3);
  int opened = 0;
  int refused = 0;
  for (const std::string name :
       {"two.mkv", "two.mov", "beside.mp4", "beside.avi", "beside.ts", "beside.webm"}) {
    std::ifstream in(folder / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    const VideoLayout layout{name[0] == 't' ? Layout::kSeparate : Layout::kSideBySide,
                             DepthCode::kInverse};
    const VideoLayout chosen = name[0] == 't' ? VideoLayout{} : layout;
    for (int i = 0; i < 40; ++i) {
      std::string damaged = bytes;
      if (i % 2 == 0) damaged.resize(bytes.size() * static_cast<std::size_t>(i) / 40);
      for (int k = 0; i % 2 == 1 && k < 8; ++k) {  // in the header, then anywhere
        const int range = i < 20 ? std::min<int>(600, static_cast<int>(bytes.size()))
                                 : static_cast<int>(bytes.size());
        damaged[static_cast<std::size_t>(random.uniform(0, range))] =
            static_cast<char>(random.uniform(0, 256));
      }
      const std::string file = folder.write("damaged_" + name, damaged);
      const LogLines log;
      try {
        const auto source = openSource(file, 0.0, false, chosen);
        ++opened;
        int frames = 0;
        while (source->read() && frames < 1000) ++frames;
        EXPECT_LE(frames, 2 * kVideoFrames) << name << " " << i;
      } catch (const SourceError& error) {
        ++refused;
        const std::string line = error.what();
        EXPECT_THAT(line, HasSubstr("damaged_" + name));
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      }
      EXPECT_LE(log.count(), 12) << log.text();
    }
  }
  EXPECT_GT(opened, 30);
  EXPECT_GT(refused, 30);
}

TEST_F(DamagedVideoFiles, ACutFileReportsWhereItEnds) {
  ffmpeg(
      "-f lavfi -i testsrc2=size=128x96:rate=30:duration=2 -c:v mjpeg -movflags +faststart c.mp4");
  std::ifstream in(folder / "c.mp4", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  const std::string file = folder.write("cut.mp4", bytes.substr(0, bytes.size() / 2));
  VideoClip source(std::make_unique<VideoFile>(file), {Layout::kSideBySide, DepthCode::kHue}, 0.0);
  const LogLines log;
  std::uint64_t last = 0;
  while (const auto frame = source.read()) last = frame->index;
  EXPECT_LT(last, 40U);
  EXPECT_THAT(log.text(),
              AllOf(HasSubstr("cut.mp4: ends after frame "), HasSubstr("states 60 frames")));
}

TEST_F(DamagedVideoFiles, TwoSizesInOneFileLeaveTheSecondOut) {
  ffmpeg("-f lavfi -i testsrc=size=64x48:rate=25 -frames:v 3 -c:v mjpeg a.mjpeg");
  ffmpeg("-f lavfi -i testsrc=size=96x80:rate=25 -frames:v 3 -c:v mjpeg b.mjpeg");
  std::string bytes;
  for (const char* name : {"a.mjpeg", "b.mjpeg"}) {
    std::ifstream in(folder / name, std::ios::binary);
    bytes.append(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  VideoClip source(std::make_unique<VideoFile>(folder.write("both.mjpeg", bytes)),
                   {Layout::kSideBySide, DepthCode::kHue}, 0.0);
  const LogLines log;
  int frames = 0;
  while (source.read()) ++frames;
  EXPECT_EQ(frames, 3);
  EXPECT_THAT(log.text(), HasSubstr("both.mjpeg: frame 3 cannot be decoded or is not 32x48"));
}

}  // namespace
}  // namespace hapticast::server
