// SPDX-License-Identifier: MIT
// A colour video beside a folder of depth images. Colour n is evenly 10 + 4 n bright, depth n is
// 500 + 100 n mm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <set>
#include <vector>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kFrames = 12;

class VideoWithDepthFiles : public VideoFilesTest {
 protected:
  /// Writes a colour video.
  void writeVideo(const std::string& name, cv::Size size = {64, 48}) const {
    std::ofstream out(folder / "v.raw", std::ios::binary);
    for (int i = 0; i < kFrames; ++i) {
      const cv::Mat picture(size, CV_8UC3, cv::Scalar::all(10 + 15 * i));
      out.write(reinterpret_cast<const char*>(picture.data),
                static_cast<std::streamsize>(picture.total() * picture.elemSize()));
    }
    out.close();
    ffmpeg("-f rawvideo -pix_fmt bgr24 -s " + std::to_string(size.width) + "x" +
           std::to_string(size.height) + " -r 60 -i v.raw -c:v libx264 -pix_fmt yuv420p -qp 4 " +
           name);
    fs::remove(folder / "v.raw");
  }
  /// Writes the depth images of all frames but those `dropped`, numbered from `first`.
  void writeDepth(const std::set<int>& dropped = {}, cv::Size size = {16, 12}, int first = 0,
                  int frames = kFrames) const {
    for (int i = 0; i < frames; ++i) {
      if (!dropped.contains(i)) folder.write(depthName(i + first), depth(i, size));
    }
  }
  [[nodiscard]] static std::string depthName(int number, const std::string& place = "depth") {
    const std::string digits = std::to_string(number);
    return place + "/" + std::string(6 - digits.size(), '0') + digits + ".png";
  }
  [[nodiscard]] static cv::Mat depth(int i, cv::Size size) {
    return {size, CV_16UC1, cv::Scalar(500 + 100 * i)};
  }
  /// Reads all frames and checks their pictures. Returns their numbers.
  [[nodiscard]] static std::vector<int> readAll(RgbdSource& source) {
    std::vector<int> numbers;
    while (const auto frame = source.read()) {
      const int i = static_cast<int>(frame->index);
      EXPECT_NEAR(frame->color.at<cv::Vec3b>(9, 9)[1], 10 + 15 * i, 4);
      EXPECT_EQ(frame->depth.size(), frame->color.size());
      EXPECT_EQ(frame->depth.at<float>(9, 9), static_cast<float>(500 + 100 * i));
      EXPECT_NEAR(frame->clip_time_s, i / source.info().fps, 1e-9);
      numbers.push_back(i);
    }
    return numbers;
  }
  [[nodiscard]] static std::vector<int> numbersWithout(const std::set<int>& dropped) {
    std::vector<int> numbers;
    for (int i = 0; i < kFrames; ++i) {
      if (!dropped.contains(i)) numbers.push_back(i);
    }
    return numbers;
  }
  [[nodiscard]] std::string folderError() const { return server::openError(folder.string()); }
};

TEST_F(VideoWithDepthFiles, ARecordingOfStrayScanner) {
  writeVideo("rgb.mp4", {1920, 1440});
  writeDepth({}, {256, 192});
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat confidence(192, 256, CV_8UC1, cv::Scalar(2));
    confidence.colRange(128, 192).setTo(1);
    confidence.colRange(192, 256).setTo(0);
    folder.write(depthName(i, "confidence"), confidence);
  }
  folder.write("camera_matrix.csv",
               std::string("1430.5, 0.0, 959.25\n0.0, 1431.5, 719.5\n0.0, 0.0, 1.0\n"));
  folder.write("odometry.csv", std::string("timestamp, frame, x\n"));
  folder.write("imu.csv", std::string("timestamp, a_x\n"));
  const LogLines log;
  const auto source = openSource(folder.string(), 0.0);
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.name, fileName(folder.string()));
  EXPECT_EQ(info.width_px, 1440) << "scaled to the stream";
  EXPECT_EQ(info.height_px, 1080);
  EXPECT_EQ(info.fps, 60.0);
  EXPECT_EQ(info.frame_count, static_cast<std::uint64_t>(kFrames));
  EXPECT_EQ(info.depth_kind, DepthKind::kMetric);
  ASSERT_TRUE(info.camera);
  EXPECT_NEAR(info.camera->fx_px, 0.75 * 1430.5, 1e-6);
  EXPECT_NEAR(info.camera->fy_px, 0.75 * 1431.5, 1e-6);
  EXPECT_NEAR(info.camera->cx_px, 0.75 * 959.75, 1e-6) << "centres of pixels";
  EXPECT_NEAR(info.camera->cy_px, 0.75 * 720.0, 1e-6);
  EXPECT_THAT(log.text(), HasSubstr("depth of 256 x 192 is scaled to 1440 x 1080"));
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.at<float>(500, 700), 500.0F);
  EXPECT_EQ(frame->depth.at<float>(500, 1000), 500.0F) << "confidence 1 counts";
  EXPECT_EQ(frame->depth.at<float>(500, 1400), 0.0F) << "confidence 0 is not measured";
}

TEST_F(VideoWithDepthFiles, MissingNumbersAreGaps) {
  writeVideo("color.mkv");
  writeDepth({0, 4, 5});
  const LogLines log;
  const auto source = openSource(folder.string(), 0.0);
  const auto kept = numbersWithout({0, 4, 5});
  EXPECT_EQ(readAll(*source), kept);
  source->rewind();
  EXPECT_TRUE(source->skip());
  EXPECT_EQ(source->read()->index, 1U);
  EXPECT_EQ(source->read()->epoch, 1U);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("depth: has no image for frame 0; frame 0 is left out"),
                                HasSubstr("has no image for frame 4; frames 4 to 5 are left out")));
}

TEST_F(VideoWithDepthFiles, APairOfAVideoAndAFolder) {
  writeVideo("a,b.mp4");
  writeDepth({3});
  fs::rename(folder / "depth", folder / "near, far");
  const auto source =
      openSource((folder / "a,b.mp4").string() + "," + (folder / "near, far").string(), 0.0);
  EXPECT_EQ(source->info().name, "a,b.mp4");
  EXPECT_FALSE(source->info().camera);
  EXPECT_EQ(readAll(*source), numbersWithout({3}));
}

TEST_F(VideoWithDepthFiles, NumbersFromOneToTheLastFrameBeginWithTheFirst) {
  writeVideo("rgb.mp4");
  writeDepth({5}, {64, 48}, 1);
  EXPECT_EQ(readAll(*openSource(folder.string(), 0.0)), numbersWithout({5}));
}

TEST_F(VideoWithDepthFiles, MetaJsonCountsAndImagesComeBeforeAVideo) {
  writeVideo("clip.mov");
  writeDepth();
  folder.write("meta.json", std::string(R"({"fps": 30, "depth_scale_m_per_unit": 0.002})"));
  const auto source = openSource(folder.string(), 0.0);
  EXPECT_EQ(source->info().fps, 30.0);
  EXPECT_EQ(source->read()->depth.at<float>(0, 0), 1000.0F);
  EXPECT_EQ(openSource(folder.string(), 12.0)->info().fps, 12.0);
  folder.write("rgb/000000.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(9)));
  EXPECT_EQ(openSource(folder.string(), 0.0)->info().frame_count, 1U) << "images, as before";
}

TEST_F(VideoWithDepthFiles, OtherLengthsAreCutOrRefused) {
  writeVideo("rgb.mp4");
  writeDepth({}, {64, 48}, 0, kFrames - 3);
  const LogLines log;
  const auto source = openSource(folder.string(), 0.0);
  EXPECT_EQ(source->info().frame_count, 9U);
  EXPECT_EQ(readAll(*source).size(), 9U);
  source->rewind();
  (void)readAll(*source);
  EXPECT_EQ(log.count(), 1) << log.text();
  EXPECT_THAT(log.text(), HasSubstr("000008.png: ends after 9 frames, before"));
  folder.write(depthName(40), depth(40, {64, 48}));
  EXPECT_THAT(folderError(),
              AllOf(HasSubstr("000040.png: is picture 41"), HasSubstr("has 12 frames")));
}

TEST_F(VideoWithDepthFiles, BrokenFoldersAreRefusedInOneLine) {
  writeVideo("rgb.mp4");
  fs::create_directories(folder / "depth");
  EXPECT_THAT(folderError(), HasSubstr("depth: has no PNG"));
  writeDepth({}, {48, 64});
  EXPECT_THAT(folderError(), AllOf(HasSubstr("000000.png: is 48x64"), HasSubstr("64x48; turn it")));
  writeDepth();
  folder.write("depth/0.png", depth(0, {16, 12}));
  EXPECT_THAT(folderError(), HasSubstr("has the same number as"));
  fs::remove(folder / "depth/0.png");
  folder.write("depth/last.png", depth(0, {16, 12}));
  EXPECT_THAT(folderError(), HasSubstr("has 13 images without frame numbers"));
  fs::remove(folder / "depth/last.png");
  for (const std::string text : {"", "1,2,3", "0,0,0,0,0,0,0,0,1", "a,b", "1e9,0,5,0,1e9,5,0,0,1",
                                 "500,0,32,0,500,24,0,0,1,7"}) {
    folder.write("camera_matrix.csv", text);
    EXPECT_THAT(folderError(), HasSubstr("camera_matrix.csv: is no 3 x 3 matrix")) << text;
  }
  fs::remove(folder / "camera_matrix.csv");
  EXPECT_THAT(errorOf([&] { (void)openSource(folder.string(), 0.0, true); }),
              HasSubstr("only images play --to-and-fro"));
  folder.write("other.mp4", std::string("x"));
  EXPECT_TRUE(openSource(folder.string(), 0.0)) << "rgb.mp4 is the colour";
  fs::rename(folder / "rgb.mp4", folder / "a.mp4");
  EXPECT_THAT(folderError(), HasSubstr("has 2 videos; name the colour video of depth/ rgb.mp4"));
}

TEST_F(VideoWithDepthFiles, DamagedImagesAreLeftOut) {
  writeVideo("rgb.mp4");
  writeDepth();
  folder.write("depth/000003.png", std::string("x"));
  folder.write("depth/000005.png", depth(5, {20, 12}));
  folder.write("confidence/000007.png", cv::Mat(5, 5, CV_8UC1, cv::Scalar(1)));
  folder.write("confidence/000008.png", cv::Mat(12, 16, CV_8UC1, cv::Scalar(1)));
  const auto source = openSource(folder.string(), 0.0);
  const LogLines log;
  EXPECT_EQ(readAll(*source), numbersWithout({3, 5, 7}));
  EXPECT_EQ(log.count(), 3) << log.text();
  EXPECT_THAT(log.text(),
              AllOf(HasSubstr("000003.png: "), HasSubstr("000005.png: is 20x12, but the clip's"),
                    HasSubstr("000007.png, which is 5x5, not 16x12")));
}

TEST_F(VideoWithDepthFiles, EightBitDepthIsHeight) {
  writeVideo("rgb.mp4");
  for (int i = 0; i < kFrames; ++i)
    folder.write(depthName(i), cv::Mat(48, 64, CV_8UC1, cv::Scalar(20 * i)));
  const auto source = openSource(folder.string(), 0.0);
  EXPECT_EQ(source->info().depth_kind, DepthKind::kHeight);
  EXPECT_TRUE(source->skip());
  EXPECT_EQ(source->read()->depth.at<float>(5, 5), 20.0F);
  const auto inverse =
      openSource(folder.string(), 0.0, false, {Layout::kSeparate, DepthCode::kInverse});
  EXPECT_TRUE(inverse->skip());
  EXPECT_EQ(inverse->read()->depth.at<float>(5, 5), 235.0F);
}

}  // namespace
}  // namespace hapticast::server
