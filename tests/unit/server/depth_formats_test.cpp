// SPDX-License-Identifier: MIT
// Every format of depth in one table: it opens with the exact depth, the number of frames and their
// times. Cut in the middle, with a damaged header, without depth or of two sizes it ends in one
// line with the file's name, or plays the frames that are whole.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "server/source/picture/depth_code.hpp"
#include "tests/support/installed.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kFormatFrames = 6;
constexpr double kFormatFps = 20.0;
const cv::Size kFormatSize{64, 48};

/// One format: how ffmpeg makes it from color.mkv (bgr24) and depth%d.png, and its source.
struct Format {
  const char* name;
  const char* ffmpeg;   ///< arguments; "" for folders
  const char* ending;   ///< of depth images in a folder; "" for videos
  const char* file;     ///< the file with the depth; --source is c.mkv and it, or it alone
  bool alone;           ///< whether it has the colour too
  double mm_per_level;  ///< 1: exact mm; 0: heights of 8 bits
};

std::ostream& operator<<(std::ostream& out, const Format& format) { return out << format.name; }

const std::vector<Format> kFormats{
    {"pair_ffv1_16", "-i depth%d.png -c:v ffv1 -pix_fmt gray16le d.mkv", "", "d.mkv", false, 1.0},
    {"pair_png_16", "-i depth%d.png -c:v png -pix_fmt gray16be d.mov", "", "d.mov", false, 1.0},
    {"pair_b16g", "-i depth%d.png -c:v rawvideo -tag:v b16g -pix_fmt gray16be d.mov", "", "d.mov",
     false, 1.0},
    {"pair_ffv1_8", "-i grey%d.png -c:v ffv1 -pix_fmt gray d.mkv", "", "d.mkv", false, 0.0},
    {"pair_png_8", "-i grey%d.png -c:v png -pix_fmt gray d.mov", "", "d.mov", false, 0.0},
    {"two_tracks_mkv",
     "-i depth%d.png -map 0 -map 1 -c:v:0 copy -c:v:1 ffv1 -pix_fmt:v:1 gray16le t.mkv", "",
     "t.mkv", true, 1.0},
    {"two_tracks_mov",
     "-i depth%d.png -map 0 -map 1 -c:v:0 mjpeg -pix_fmt:v:0 yuvj420p -c:v:1 png -pix_fmt:v:1 "
     "gray16be t.mov",
     "", "t.mov", true, 1.0},
    {"folder_png_16", "", ".png", "", true, 1.0},
    {"folder_tif_16", "", ".tif", "", true, 1.0},
    {"folder_pgm_16", "", ".pgm", "", true, 1.0},
};

/// Six frames of 20 per second. The depth is 300 + 40 frame + 10 column + row mm; heights are
/// 20 frame + 2 column.
class DepthFormats : public testing::TestWithParam<Format> {
 protected:
  void SetUp() override {
    if (!isInstalled("ffmpeg")) GTEST_SKIP() << "needs ffmpeg";
    for (int i = 0; i < kFormatFrames; ++i) {
      const std::string number = std::to_string(i + 1);
      cv::Mat depth(kFormatSize, CV_16UC1);
      cv::Mat grey(kFormatSize, CV_8UC1);
      for (int v = 0; v < kFormatSize.height; ++v) {
        for (int u = 0; u < kFormatSize.width; ++u) {
          depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(depthAt(i, u, v));
          grey.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(heightAt(i, u));
        }
      }
      folder.write("depth" + number + ".png", depth);
      folder.write("grey" + number + ".png", grey);
      folder.write("color" + number + ".png",
                   cv::Mat(kFormatSize, CV_8UC3, cv::Scalar(40, 90, 20 * i)));
      if (GetParam().ending[0] == '\0') continue;
      folder.write("clip/rgb/" + number + ".png",
                   cv::Mat(kFormatSize, CV_8UC3, cv::Scalar::all(90)));
      folder.write("clip/depth/" + number + GetParam().ending, depth);
    }
    if (GetParam().ending[0] != '\0') return;
    folder.ffmpeg(fmt::format("-r {} -i color%d.png -c:v ffv1 -pix_fmt bgr0 c.mkv", kFormatFps));
    folder.ffmpeg(fmt::format("{}-r {} {}", GetParam().alone ? "-i c.mkv " : "", kFormatFps,
                              GetParam().ffmpeg));
  }
  static double depthAt(int frame, int u, int v) { return 300.0 + 40.0 * frame + 10.0 * u + v; }
  static double heightAt(int frame, int u) { return 20.0 * frame + 2.0 * u; }
  [[nodiscard]] bool isFolder() const { return GetParam().ending[0] != '\0'; }
  /// The file with the depth, or with the depth of the frame in the middle.
  [[nodiscard]] std::string depthFile() const {
    return (folder / (isFolder()
                          ? fmt::format("clip/depth/{}{}", kFormatFrames / 2, GetParam().ending)
                          : std::string(GetParam().file)))
        .string();
  }
  [[nodiscard]] std::string spec() const {
    if (isFolder()) return (folder / "clip").string();
    if (GetParam().alone) return depthFile();
    return (folder / "c.mkv").string() + "," + depthFile();
  }
  [[nodiscard]] std::string readDepthFile() const {
    std::ifstream in(depthFile(), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }
  void writeDepthFile(const std::string& bytes) const {
    std::ofstream(depthFile(), std::ios::binary) << bytes;
  }
  void expectDepth(const RgbdFrame& frame) const {
    const bool metric = GetParam().mm_per_level > 0.0;
    const int index = static_cast<int>(frame.index);
    for (int v = 0; v < kFormatSize.height; ++v) {
      for (int u = 0; u < kFormatSize.width; ++u) {
        const double wanted = metric ? depthAt(index, u, v) : heightAt(index, u);
        ASSERT_EQ(double(frame.depth.at<float>(v, u)), wanted) << index << ' ' << u << ' ' << v;
      }
    }
  }
  /// Opens and plays the source. Frames that play have their depth, every problem names the file.
  /// Returns the number of frames.
  int playCompleteFrames() const {
    const LogLines log;
    int frames = 0;
    try {
      const auto source = openSource(spec(), isFolder() ? kFormatFps : 0.0);
      while (const auto frame = source->read()) {
        ++frames;
        EXPECT_DOUBLE_EQ(frame->clip_time_s, static_cast<double>(frame->index) / kFormatFps);
      }
    } catch (const SourceError& error) {
      const std::string line = error.what();
      EXPECT_THAT(line, HasSubstr(std::filesystem::path(depthFile()).filename().string()));
      EXPECT_EQ(line.find('\n'), std::string::npos) << line;
      return -1;
    }
    if (frames < kFormatFrames) {
      EXPECT_THAT(log.text(), HasSubstr(std::filesystem::path(depthFile()).filename().string()));
    }
    return frames;
  }
  SourceFolder folder;
};

INSTANTIATE_TEST_SUITE_P(Table, DepthFormats, testing::ValuesIn(kFormats),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(DepthFormats, OpensWithExactDepthAndTimes) {
  const LogLines log;
  const auto source = openSource(spec(), isFolder() ? kFormatFps : 0.0);
  EXPECT_EQ(source->info().depth_kind,
            GetParam().mm_per_level > 0.0 ? DepthKind::kMetric : DepthKind::kHeight);
  EXPECT_NEAR(source->info().fps, kFormatFps, 0.01);
  EXPECT_EQ(source->info().frame_count, static_cast<std::uint64_t>(kFormatFrames));
  for (int i = 0; i < kFormatFrames; ++i) {
    const auto frame = source->read();
    ASSERT_TRUE(frame) << i;
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_NEAR(frame->clip_time_s, i / kFormatFps, 1e-6);
    expectDepth(*frame);
  }
  EXPECT_FALSE(source->read());
  EXPECT_EQ(log.count(), 0) << log.text();
}

TEST_P(DepthFormats, PlaysTheCompleteFramesOfACutFile) {
  const std::string bytes = readDepthFile();
  writeDepthFile(bytes.substr(0, bytes.size() / 2));
  EXPECT_LT(playCompleteFrames(), kFormatFrames);
}

TEST_P(DepthFormats, AWrongHeaderIsReportedWithTheFile) {
  std::string bytes = readDepthFile();
  std::fill_n(bytes.begin(), std::min<std::size_t>(bytes.size(), 64), '\x5A');
  writeDepthFile(bytes);
  EXPECT_LT(playCompleteFrames(), isFolder() ? kFormatFrames : 0);
}

TEST_P(DepthFormats, WithoutDepthItIsRefused) {
  if (isFolder()) {
    std::filesystem::remove_all(folder / "clip/depth");
    EXPECT_THAT(openError(spec()), HasSubstr("has no folder depth/"));
  } else {
    EXPECT_THAT(openError((folder / "c.mkv").string()),
                AllOf(HasSubstr("c.mkv: "), HasSubstr("depth is needed too")));
  }
}

}  // namespace
}  // namespace hapticast::server
