// SPDX-License-Identifier: MIT
// Warnings for input that is probably a mistake.
#include "server/pipeline/input_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/source/synthetic/synthetic_source.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/support/clips.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using test::BallScene;
using test::FunctionSource;
using ::testing::HasSubstr;

struct Outcome {
  bool can_touch = false;
  std::string text;
  long lines = 0;
};

Outcome check(RgbdSource& source, const VisionSettings& settings = {}) {
  const LogLines log;
  const bool can_touch = warnOfUnlikelyInput(source, settings);
  return {can_touch, log.text(), log.count()};
}

Outcome check(const BallScene& scene, const std::function<void(RgbdFrame&)>& change) {
  FunctionSource source(scene.info(), 8, [&](std::uint64_t i) {
    RgbdFrame frame = scene.frame(i, 0.5 * scene.width, 0.5 * scene.height);
    change(frame);
    return frame;
  });
  return check(source);
}

TEST(InputCheck, AnUsualClipIsReadFromItsBeginAfterwards) {
  const BallScene scene;
  FunctionSource source(scene.info(), 8, [&](std::uint64_t i) { return scene.frame(i, 160, 120); });
  const Outcome usual = check(source);
  EXPECT_TRUE(usual.can_touch);
  EXPECT_EQ(usual.text, "");
  EXPECT_EQ(source.read()->index, 0U);
}

TEST(InputCheck, DepthOfOneValueHasNothingToTouch) {
  for (const double value : {0.0, 255.0}) {
    const Outcome empty = check({}, [value](RgbdFrame& frame) {
      frame.depth = cv::Mat(frame.depth.size(), CV_32FC1, cv::Scalar(value));
    });
    EXPECT_FALSE(empty.can_touch);
    EXPECT_EQ(empty.lines, 1) << empty.text;
    EXPECT_THAT(empty.text, HasSubstr("in every pixel of the first 5 frames, so there is nothing"));
  }
  const Outcome late = check({}, [](RgbdFrame& frame) {
    if (frame.index < 2) frame.depth = cv::Mat::zeros(frame.depth.size(), CV_32FC1);
  });
  EXPECT_EQ(late.text, "") << "a sensor that starts";
}

TEST(InputCheck, ATinyPictureIsReported) {
  const Outcome tiny = check({.width = 16, .height = 12, .radius_px = 3}, [](RgbdFrame&) {});
  EXPECT_FALSE(tiny.can_touch);
  EXPECT_EQ(tiny.lines, 1);
  EXPECT_THAT(
      tiny.text,
      HasSubstr("is 16x12 px, too small to touch anything; use a picture of at least 64x48 px"));
  EXPECT_EQ(check({.width = 48, .height = 64, .radius_px = 12}, [](RgbdFrame&) {}).text, "");
}

TEST(InputCheck, RangesInMetresAreReported) {
  SyntheticSource source(SceneKind::kStill);
  VisionSettings settings;
  settings.map_range = DepthRange{0.5, 1.2};
  settings.depth_range = DepthRange{0.6, 4};
  EXPECT_EQ(check(source, settings).text,
            "warning --map-range 0.5,1.2: these are millimetres; did you mean 500,1200?\n"
            "warning --depth-range 0.6,4: these are millimetres; did you mean 600,4000?\n");
  settings.map_range = DepthRange{0, 25};
  settings.depth_range = DepthRange{500, 1200};
  EXPECT_EQ(check(source, settings).text, "");
}

/// The clip's depth as 8-bit depth, near as white and without a measurement black.
cv::Mat toLevels(const cv::Mat& depth_mm, const DepthRange& range) {
  const double scale = 255.0 / (range.far_mm - range.near_mm);
  cv::Mat levels;
  cv::Mat((range.far_mm - depth_mm) * scale).convertTo(levels, CV_8U);
  levels.setTo(0, depth_mm == 0.0F);
  cv::Mat out;
  levels.convertTo(out, CV_32F);
  return out;
}

struct CheckedClip {
  std::string folder;
  DepthRange range;  // 1 and 99 % of its depths
  std::vector<AuthorPoint> clicks;
};

std::vector<CheckedClip> realClips() {
  const auto shared = [](const char* name) { return (test::clipsFolder() / name).string(); };
  return {{HAPTICAST_TESTS "/data/typing_hands", {534, 1116}, {}},
          {HAPTICAST_TESTS "/data/typing_hands", {534, 1116}, {{{167, 111}}}},
          {shared("dkvfx_typing_person"), {534, 1116}, {{{260, 290}}}},
          {shared("tum_fr1_rpy"), {708, 3458}, {}},
          {shared("visp_rbt_desk"), {260, 4497}, {}},
          {shared("visp_rbt_desk"), {260, 4497}, {{{430, 260}}}}};
}

TEST(InputCheck, TheBorderIsNearerThanTheObjectOnlyInInvertedDepth) {
  for (const CheckedClip& clip : realClips()) {
    if (!std::filesystem::exists(clip.folder)) continue;
    const auto source = openSource(clip.folder, 0.0);
    VisionSettings settings;
    settings.object_points = clip.clicks;
    for (int i = 0; i < 5; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame);
      const cv::Mat levels = toLevels(frame->depth, clip.range);
      EXPECT_LT(shareOfNearBorder(levels, settings), 0.3) << clip.folder << " " << i;
      EXPECT_GT(shareOfNearBorder(255.0 - levels, settings), 0.65) << clip.folder << " " << i;
    }
  }
}

TEST(InputCheck, InvertedDepthIsReportedOfEightBitDepthOnly) {
  const BallScene scene{.kind = DepthKind::kHeight};
  const auto levels = [](RgbdFrame& frame, bool inverted) {
    const cv::Mat near_is_white = toLevels(frame.depth, {600, 1300});
    frame.depth = inverted ? cv::Mat(255.0 - near_is_white) : near_is_white;
  };
  BallScene metric_scene;
  FunctionSource inverted(scene.info(), 8, [&](std::uint64_t i) {
    RgbdFrame frame = metric_scene.frame(i, 160, 120);
    levels(frame, true);
    return frame;
  });
  FunctionSource usual(scene.info(), 8, [&](std::uint64_t i) {
    RgbdFrame frame = metric_scene.frame(i, 160, 120);
    levels(frame, false);
    return frame;
  });
  VisionSettings settings;
  settings.object_points = {{{160, 120}}};
  EXPECT_EQ(check(usual, settings).text, "");
  const Outcome outcome = check(inverted, settings);
  EXPECT_TRUE(outcome.can_touch);
  EXPECT_EQ(outcome.lines, 1);
  EXPECT_THAT(outcome.text, HasSubstr("its depth looks inverted"));
}

/// Messages when a clip with one image of each name is opened.
std::string warningsOf(const SourceFolder& clip) {
  const LogLines log;
  (void)openSource(clip.string(), 0.0);
  EXPECT_LE(log.count(), 1) << log.text();
  return log.text();
}

TEST(InputCheck, PairsWithOtherFrameNumbersAreReportedOnce) {
  const cv::Mat color(24, 32, CV_8UC3, cv::Scalar::all(9));
  const cv::Mat depth(24, 32, CV_16UC1, cv::Scalar(900));
  const auto warnings = [&](const std::vector<std::pair<std::string, std::string>>& names) {
    const SourceFolder clip;
    for (const auto& [of_color, of_depth] : names) {
      clip.write("rgb/" + of_color + ".png", color);
      clip.write("depth/" + of_depth + ".png", depth);
    }
    return warningsOf(clip);
  };
  EXPECT_THAT(warnings({{"000000", "000001"}, {"000001", "000002"}}),
              HasSubstr("depth/000001.png: belongs to colour 000000.png by its place, but the"));
  EXPECT_THAT(warnings({{"a1", "b1"}, {"a2", "b3"}}),
              HasSubstr("b3.png: belongs to colour a2.png"));
  EXPECT_EQ(warnings({{"frame_9", "d09"}, {"frame_10", "d10"}}), "");
  EXPECT_EQ(warnings({{"1305031102.175", "1305031102.160"}}), "") << "time stamps";
  EXPECT_EQ(warnings({{"1305031102175", "1305031102160"}}), "") << "time stamps";
  EXPECT_EQ(warnings({{"left", "right"}}), "") << "no numbers";
}

TEST(InputCheck, AnotherSizeInMetaJsonIsReported) {
  const auto warnings = [](const std::string& meta) {
    const SourceFolder clip;
    clip.write("rgb/1.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(9)));
    clip.write("depth/1.png", cv::Mat(24, 32, CV_16UC1, cv::Scalar(900)));
    clip.write("meta.json", meta);
    return warningsOf(clip);
  };
  EXPECT_EQ(warnings(R"({"width": 32, "height": 24})"), "");
  EXPECT_THAT(warnings(R"({"width": 1920, "height": 1080})"),
              HasSubstr("meta.json: states 1920x1080, but the pictures are 32x24; the server uses "
                        "the intrinsics as those of the pictures"));
  EXPECT_THAT(warnings(R"({"width": 64})"), HasSubstr("states 64x24"));
}

TEST(InputCheck, SyntheticScenesAreUsual) {
  for (const SceneName& scene : kSceneNames) {
    SyntheticSource source(scene.kind);
    EXPECT_EQ(check(source).text, "") << scene.name;
    source.rewind();
    const cv::Mat levels = toLevels(source.read()->depth, *source.info().depth_range);
    EXPECT_LT(shareOfNearBorder(levels, {}), 0.3) << scene.name;
  }
}

}  // namespace
}  // namespace hapticast::server
