// SPDX-License-Identifier: MIT
// Clips as other programs write them, made of tests/data/typing_hands: each one opens with the
// right depth, or is refused with the cause and the remedy. tests/README.md has the same table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/pipeline/input_check.hpp"
#include "server/source/video_layout.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 6;
constexpr int kFew_mm = 1;  // what rounding to units of 1 mm may change

/// Colour and depth (CV_16UC1, mm) of the clip.
struct Frames {
  std::vector<cv::Mat> colors;
  std::vector<cv::Mat> depths;
};

const Frames& frames() {
  static const Frames kAll = [] {
    Frames all;
    for (int i = 0; i < kFrames; ++i) {
      const std::string file = fmt::format("/{:06d}.png", i);
      all.colors.push_back(cv::imread(HAPTICAST_TESTS "/data/typing_hands/rgb" + file));
      all.depths.push_back(
          cv::imread(HAPTICAST_TESTS "/data/typing_hands/depth" + file, cv::IMREAD_UNCHANGED));
    }
    return all;
  }();
  return kAll;
}

/// The depth `depth_mm` in units of `mm_per_unit`, CV_16UC1.
cv::Mat inUnits(const cv::Mat& depth_mm, double mm_per_unit) {
  cv::Mat out;
  depth_mm.convertTo(out, CV_16U, 1.0 / mm_per_unit);
  return out;
}
cv::Mat asFloats(const cv::Mat& depth_mm, double mm_per_unit) {
  cv::Mat out;
  depth_mm.convertTo(out, CV_32F, 1.0 / mm_per_unit);
  return out;
}

class LayoutsTest : public VideoFilesTest {
 protected:
  using Name = std::function<std::string(int frame)>;
  static Name numbered(const std::string& before, const std::string& behind) {
    return [=](int frame) { return fmt::format("{}{:06d}{}", before, frame, behind); };
  }
  void writeColors(const Name& name = numbered("rgb/", ".png")) const {
    for (int i = 0; i < kFrames; ++i) folder.write(name(i), frames().colors[std::size_t(i)]);
  }
  /// Writes depths that are `far` times those of the clip.
  void writeDepths(const Name& name = numbered("depth/", ".png"), double mm_per_unit = 1.0,
                   bool floats = false, double far = 1.0) const {
    for (int i = 0; i < kFrames; ++i) {
      const cv::Mat depth_mm = frames().depths[std::size_t(i)] * far;
      folder.write(name(i),
                   floats ? asFloats(depth_mm, mm_per_unit) : inUnits(depth_mm, mm_per_unit));
    }
  }
  /// Expects that `spec` has the clip's frames, and `far` times its depths, up to `few_mm`.
  static void expectRight(const std::string& spec, const VideoLayout& layout = {},
                          double few_mm = kFew_mm, double far = 1.0) {
    const auto source = openSource(spec, 24.0, false, layout);
    for (int i = 0; i < kFrames; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame) << i;
      cv::Mat truth_mm;
      frames().depths[std::size_t(i)].convertTo(truth_mm, CV_32F, far);
      EXPECT_LE(cv::norm(frame->depth, truth_mm, cv::NORM_INF), few_mm) << i;
      EXPECT_LE(cv::norm(frame->color, frames().colors[std::size_t(i)], cv::NORM_L1) /
                    double(3 * frame->color.total()),
                6.0)
          << i;
    }
    EXPECT_FALSE(source->read());
  }
  [[nodiscard]] std::string warningsOf(const std::string& spec,
                                       const VideoLayout& layout = {}) const {
    const auto source = openSource(spec, 24.0, false, layout);
    const LogLines log;
    (void)warnOfUnlikelyInput(*source, {});
    return log.text();
  }
};

VideoLayout withUnit(double mm_per_unit) {
  VideoLayout layout;
  layout.depth_unit_mm = mm_per_unit;
  return layout;
}

struct UnitRow {
  const char* program;
  double mm_per_unit;
  bool floats;
  double few_mm;          ///< half of a unit, and rounding
  const char* suggested;  ///< in the warning without the flag
  double far = 1.0;       ///< depths of the scene against those of the clip
};

TEST_F(LayoutsTest, EveryUnitOpensRightWithItsFlagAndIsSuspectedWithoutIt) {
  for (const UnitRow& row : {
           UnitRow{"TUM, ORB-SLAM: 1/5000 m", 0.2, false, 0.11, "--depth-unit 0.2 (", 3.0},
           UnitRow{"RealSense: 0.1 mm", 0.1, false, 0.06, "--depth-unit 0.1 (", 2.0},
           UnitRow{"FFmpeg, gray12le", 16.0, false, 8.1, "--depth-unit 16 ("},
           UnitRow{"FFmpeg, gray10le", 64.0, false, 32.1, "--depth-unit 64 ("},
           UnitRow{"mm as floats", 1.0, true, 0.01, "--depth-unit 1 ("},
       }) {
    SCOPED_TRACE(row.program);
    writeColors();
    const std::string ending = row.floats ? ".tiff" : ".png";
    writeDepths(numbered("depth/", ending), row.mm_per_unit, row.floats, row.far);
    expectRight(folder.string(), withUnit(row.mm_per_unit), row.few_mm, row.far);
    EXPECT_EQ(warningsOf(folder.string(), withUnit(row.mm_per_unit)), "");
    EXPECT_THAT(warningsOf(folder.string()), HasSubstr(row.suggested));
    std::filesystem::remove_all(folder / "depth");
  }
}

TEST_F(LayoutsTest, UsualUnitsNeedNoFlagAndNoWarning) {
  writeColors();
  for (const bool floats : {false, true}) {
    writeDepths(numbered("depth/", floats ? ".tiff" : ".png"), floats ? 1000.0 : 1.0, floats);
    expectRight(folder.string());
    EXPECT_EQ(warningsOf(folder.string()), "") << floats;
    std::filesystem::remove_all(folder / "depth");
  }
}

TEST_F(LayoutsTest, DepthThatWasSqueezedIntoEightBitsIsSuspected) {
  writeColors();
  for (int i = 0; i < kFrames; ++i) {
    cv::Mat squeezed;
    frames().depths[std::size_t(i)].convertTo(squeezed, CV_8U, 1.0 / 256.0);
    folder.write(numbered("depth/", ".png")(i), squeezed);
  }
  EXPECT_THAT(warningsOf(folder.string()), HasSubstr("probably depth of 16 bits before"));
  EXPECT_THAT(errorOf([this] { (void)openSource(folder.string(), 0.0, false, withUnit(256.0)); }),
              HasSubstr("has depth of 8 bits, which are heights; leave --depth-unit out"));
}

struct NameRow {
  const char* program;
  const char* color;
  const char* depth;
  const char* color_behind = ".png";
  const char* depth_behind = ".png";
};

TEST_F(LayoutsTest, EveryFolderOfAnAppOpens) {
  for (const NameRow& row : {
           NameRow{"rs_bag2image", "Color/", "Depth/"},
           NameRow{"capital letters", "RGB/", "DEPTH/"},
           NameRow{"rgbd-slam-tutorial", "rgb_png/", "depth_png/"},
           NameRow{"slambook2 ch7: 1.png, 1_depth.png", "", "", ".png", "_depth.png"},
           NameRow{"3D Scanner App", "frame_", "depth_", ".jpg", ".png"},
           NameRow{"depth in front", "color-", "Depth-", ".jpg", ".png"},
       }) {
    SCOPED_TRACE(row.program);
    const SourceFolder before;  // of its own, so that no folder remains
    writeColors(numbered(row.color, row.color_behind));
    writeDepths(numbered(row.depth, row.depth_behind));
    folder.write("conf_000000.png", cv::Mat(8, 8, CV_8UC1, cv::Scalar(1)));
    expectRight(folder.string());
    for (const auto& entry : std::filesystem::directory_iterator(folder.string()))
      std::filesystem::remove_all(entry.path());
  }
}

TEST_F(LayoutsTest, PatternsNameTheImagesOfEveryOtherFolder) {
  writeColors(numbered("left [1]/cam_", "_c.png"));
  writeDepths(numbered("left [1]/d/z", ".png"));
  VideoLayout layout;
  layout.color_glob = "left \\[1\\]/*_c.{png,jpg}";
  layout.depth_glob = "left*/d/*.png";
  expectRight(folder.string(), layout);
  layout.depth_glob = "left*/d/*.pgm";
  EXPECT_THAT(errorOf([&] { (void)openSource(folder.string(), 0.0, false, layout); }),
              HasSubstr("--depth 'left*/d/*.pgm': matches no file in"));
  layout.depth_glob = "";
  EXPECT_THAT(errorOf([&] { (void)openSource(folder.string(), 0.0, false, layout); }),
              HasSubstr("each needs the other"));
  layout.depth_glob = "x";
  EXPECT_THAT(errorOf([&] { (void)openSource("a.mp4,b.mkv", 0.0, false, layout); }),
              HasSubstr("only a folder of images has --color and --depth"));
}

TEST_F(LayoutsTest, FilesThatAreNoVideoAreNamed) {
  struct Row {
    const char* file;
    std::string content;
    const char* cause;
  };
  const std::string zip("PK\x03\x04 and more");
  for (const Row& row : std::vector<Row>{
           {"a.bag", "#ROSBAG V2.0\n",
            "a.bag --dst a_mcap --dst-storage mcap), and use the folder"},
           {"a.db3", "SQLite format 3 and more", "a.db3 -o out.yaml), and use the folder a_mcap"},
           {"a.r3d", zip, "is a capture of Record3D; export it there as an RGBD video"},
           {"a.npz", zip, "has depth only; name the colour video too: COLOR,FILE.npz"},
           {"a.npy", "\x93NUMPY and more", "has depth only; name the colour video too"},
           {"a.zip", zip, "is an archive; unpack it"},
           {"clip", "\x1F\x8B and more", "is an archive; unpack it"},
           {"a.png", "\x89PNG and more", "is one picture; use a folder with rgb/ and depth/"},
       }) {
    EXPECT_THAT(openError(folder.TempFolder::write(row.file, row.content)), HasSubstr(row.cause))
        << row.file;
  }
}

}  // namespace
}  // namespace hapticast::server
