// SPDX-License-Identifier: MIT
// --preview: the pictures are there and show what was taken; places that cannot be written to; the
// author's points after the end of a clip.
#include "server/preview/preview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "server/pipeline/clip_scan.hpp"
#include "server/preview/correction_hint.hpp"
#include "server/preview/picture_axes.hpp"
#include "server/source/synthetic/synthetic_source.hpp"
#include "server/vision/base/masks.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Preview : ::testing::Test {
  SourceFolder folder;
  const SteadyClock clock{};

  [[nodiscard]] Settings settingsFor(const std::string& place) const {
    Settings settings;
    settings.source = "synthetic:still";
    settings.frames = 6;
    settings.preview = (folder / place).string();
    settings.vision.motion = MotionMode::kNone;
    return settings;
  }
  /// What it prints.
  [[nodiscard]] std::string run(const Settings& settings) const {
    ::testing::internal::CaptureStdout();
    try {
      writePreview(settings, clock);
    } catch (...) {
      (void)::testing::internal::GetCapturedStdout();
      throw;
    }
    return ::testing::internal::GetCapturedStdout();
  }
};

TEST_F(Preview, ShowsTheOutlineWhereTheMaskIsAndTheReliefBesideIt) {
  const std::string said = run(settingsFor("a.png"));
  EXPECT_THAT(said, AllOf(HasSubstr("object 1: "), HasSubstr("no object found in 0 of 6 frames"),
                          HasSubstr("written: ")));
  const cv::Mat picture = cv::imread((folder / "a.png").string());
  const auto frame = SyntheticSource(SceneKind::kStill).read();
  ASSERT_TRUE(frame);
  ASSERT_EQ(picture.cols, 2 * (frame->color.cols + kAxisLeft_px) + frame->color.cols)
      << "picture, close-up, relief";
  ASSERT_GT(picture.rows, kAxisTop_px + frame->color.rows) << "lines of text below";
  const cv::Rect left({kAxisLeft_px, kAxisTop_px}, frame->color.size());
  cv::Mat changed;
  cv::absdiff(picture(left), frame->color, changed);
  cv::transform(changed, changed, cv::Matx13f(1, 1, 1));
  for (int at = 0; at < frame->color.cols; at += tickStep_px(1.0)) {
    changed.col(at).setTo(0);  // the grid
    if (at < changed.rows) changed.row(at).setTo(0);
  }
  const cv::Mat mask = frame->mask > 0;
  const cv::Mat rim = mask & ~erodeBy(mask, 1);
  EXPECT_LT(cv::countNonZero(rim & (changed == 0)), 20) << "a gap in the outline";
  EXPECT_EQ(cv::countNonZero(~dilateBy(mask, 6) & (changed > 0)), 0) << "drawn elsewhere";
  cv::Mat relief;
  cv::cvtColor(picture(cv::Rect({picture.cols - left.width, kAxisTop_px}, left.size())), relief,
               cv::COLOR_BGR2GRAY);
  const cv::Rect lit = cv::boundingRect(relief);
  EXPECT_GT(lit.height, 400) << "as large as fits";
  EXPECT_NEAR(double(lit.width) / lit.height, 1.0, 0.1) << "a ball";
  const cv::Rect inner(lit.x + lit.width / 4, lit.y + lit.height / 4, lit.width / 2,
                       lit.height / 2);
  double darkest = 0.0;
  double brightest = 0.0;
  cv::minMaxLoc(relief(inner), &darkest, &brightest);
  EXPECT_GT(brightest - darkest, 30.0) << "a ball lit from one side";
}

TEST_F(Preview, AFolderGetsASheetOfTheClip) {
  const std::string said = run(settingsFor("sheet"));
  EXPECT_THAT(said, AllOf(HasSubstr("sheet/first.png"), HasSubstr("sheet/clip.png")));
  EXPECT_FALSE(cv::imread((folder / "sheet/first.png").string()).empty());
  EXPECT_EQ(cv::imread((folder / "sheet/clip.png").string()).size(), cv::Size(6 * 240, 180));
}

TEST_F(Preview, PlacesThatCannotBeWrittenToAreReportedInOneLine) {
  folder.write("file", std::string("x"));
  const auto refusal = [&](const char* place) {
    return errorOf([&] { (void)run(settingsFor(place)); });
  };
  EXPECT_THAT(refusal("file/below"), AllOf(HasSubstr("--preview "), HasSubstr("is not a folder")));
  EXPECT_THAT(refusal("none/a.png"), AllOf(HasSubstr("--preview "), HasSubstr("be written")));
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_F(Preview, ReportsAFailedStartInTheUsualLine) {
  Settings settings = settingsFor("a.png");
  settings.vision.object_points = {{{2, 2}}};
  EXPECT_THAT(errorOf([&] { (void)run(settings); }), HasSubstr("--object 2,2"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

// Images of a body at 0.7 m, all of `mask`, before a wall at 1.5 m.
FrameImages makeImages(const cv::Mat& color, const cv::Mat& mask) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Mat depth(color.size(), CV_32FC1, cv::Scalar(1500));
  depth.setTo(700, mask);
  return {color, gray, depth, {}, {}};
}

TEST(PreviewAdvice, PointsAtTheHandThatTheMaskHolds) {
  cv::Mat color(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  cv::Mat mask = cv::Mat::zeros(color.size(), CV_8UC1);
  cv::circle(color, {150, 120}, 40, {60, 120, 60}, cv::FILLED);
  cv::circle(mask, {150, 120}, 40, cv::Scalar(255), cv::FILLED);
  EXPECT_FALSE(suggestCorrection(makeImages(color, mask), mask, {})) << "one colour, no edge";
  const cv::Rect hand(185, 100, 50, 30);
  color(hand).setTo(cv::Scalar(120, 150, 210));
  mask(hand).setTo(255);
  const auto doubt = suggestCorrection(makeImages(color, mask), mask, {});
  ASSERT_TRUE(doubt);
  EXPECT_TRUE(hand.contains(doubt->at_px)) << doubt->at_px;
  EXPECT_THAT(doubt->why, HasSubstr("skin"));
  mask(cv::Rect(185, 100, 135, 30)).setTo(255);
  const auto arm = suggestCorrection(makeImages(color, mask), mask, {});
  ASSERT_TRUE(arm);
  EXPECT_GT(arm->at_px.x, 300);
  EXPECT_THAT(arm->why, HasSubstr("edge"));
}

TEST(PreviewAdvice, NeverContradictsAClickOfTheAuthor) {
  cv::Mat color(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  cv::Mat mask = cv::Mat::zeros(color.size(), CV_8UC1);
  cv::circle(color, {150, 120}, 40, {60, 120, 60}, cv::FILLED);
  cv::circle(mask, {150, 120}, 40, cv::Scalar(255), cv::FILLED);
  const cv::Rect hand(185, 80, 50, 70);
  color(hand).setTo(cv::Scalar(120, 150, 210));
  mask(hand).setTo(255);
  const auto hint = suggestCorrection(makeImages(color, mask), mask, {});
  ASSERT_TRUE(hint);
  EXPECT_TRUE(suggestCorrection(makeImages(color, mask), mask, {{130, 120}}))
      << "the click is on another part";
  for (int v = 84; v < 148; v += 20) {
    for (int u = 189; u < 233; u += 16) {
      const cv::Point click(u, v);
      const auto left = suggestCorrection(makeImages(color, mask), mask, {{130, 120}, click});
      if (!left) continue;
      EXPECT_GT(cv::norm(left->at_px - click), 19.0) << click;
      EXPECT_FALSE(hand.contains(left->at_px)) << "on the region of the click " << click;
    }
  }
  EXPECT_FALSE(suggestCorrection(makeImages(color, mask), mask, {hint->at_px + cv::Point(3, 2)}))
      << "the hand";
  mask(cv::Rect(185, 100, 135, 30)).setTo(255);
  const auto arm = suggestCorrection(makeImages(color, mask), mask, {});
  ASSERT_TRUE(arm);
  const auto other = suggestCorrection(makeImages(color, mask), mask, {arm->at_px});
  EXPECT_TRUE(!other || cv::norm(other->at_px - arm->at_px) > 19.0);
}

TEST(PictureScaleAxes, TicksAreRoundNumbersThatDoNotTouch) {
  EXPECT_EQ(tickStep_px(1.0), 100);
  EXPECT_EQ(tickStep_px(1.5), 50);
  EXPECT_EQ(tickStep_px(0.5), 200);
  EXPECT_EQ(tickStep_px(8.0), 10);
  EXPECT_EQ(tickStep_px(80.0), 1);
  EXPECT_EQ(computePixelPlace({110, 60}, {100, 50, 160, 120}, 4.0), cv::Point(42, 42));
}

TEST(PictureScaleAxes, SmallObjectsHaveACloseUpInsideThePicture) {
  const cv::Size size(640, 480);
  const cv::Rect whole({0, 0}, size);
  EXPECT_EQ(selectCloseUp({}, size), whole);
  EXPECT_EQ(selectCloseUp({100, 100, 300, 200}, size), whole) << "large";
  for (const cv::Rect& box :
       {cv::Rect(300, 200, 80, 60), cv::Rect(0, 0, 40, 40), cv::Rect(600, 440, 40, 40)}) {
    const cv::Rect near = selectCloseUp(box, size);
    EXPECT_LE(near.width, size.width / 2);
    EXPECT_EQ(near & box, box) << "the whole object";
    EXPECT_EQ(near & whole, near);
    EXPECT_NEAR(double(near.width) / near.height, 4.0 / 3.0, 0.03) << near;
  }
}

TEST_F(Preview, DrawsTheAuthorsPoints) {
  Settings settings = settingsFor("a.png");
  settings.vision.object_points = {{{320, 240}}};
  settings.vision.not_points = {{{50, 60}}};
  (void)run(settings);
  const cv::Mat picture = cv::imread((folder / "a.png").string());
  const auto colorAt = [&](int u, int v) {
    return picture.at<cv::Vec3b>(kAxisTop_px + v, kAxisLeft_px + u);
  };
  EXPECT_EQ(colorAt(320, 240), cv::Vec3b(90, 255, 90));
  EXPECT_EQ(colorAt(320, 246), cv::Vec3b(90, 255, 90)) << "an upright cross";
  EXPECT_EQ(colorAt(50, 60), cv::Vec3b(80, 80, 255));
  EXPECT_EQ(colorAt(55, 65), cv::Vec3b(80, 80, 255)) << "a tilted cross";
}

TEST_F(Preview, WritesASceneThatBeginsWithTheSameObject) {
  Settings settings = settingsFor("sheet");
  settings.vision.segment = SegmentMode::kBand;
  const std::string said = run(settings);
  EXPECT_THAT(said, HasSubstr("/sheet/scene.json"));
  std::ifstream file(folder / "sheet/scene.json");
  const Scene scene = parseScene(std::string(std::istreambuf_iterator<char>(file), {}));
  ASSERT_EQ(scene.objects.size(), 1U);
  ASSERT_EQ(scene.objects[0].points.size(), 1U);
  settings.scene = scene;
  settings.vision.object_points = scene.objects[0].points;
  settings.vision.objects = {{"ball", {}}};
  const std::string again = run(settings);
  EXPECT_THAT(again, HasSubstr("'ball', object 1: "));
  const auto facts = [](const std::string& text) {
    const std::size_t begin = text.find("object 1: ");
    return text.substr(begin, text.find('\n') - begin);
  };
  EXPECT_EQ(facts(again), facts(said)) << "the same mask";
}

TEST(AuthorPoints, AfterTheEndOfTheClipAreReportedAndSkipped) {
  SourceInfo info;
  info.fps = 25.0;
  info.frame_count = 50;
  VisionSettings settings;
  settings.object_points = {{{10, 20}}, {{30, 40}, 1.96}, {{50, 60}, 2.0}};
  settings.not_points = {{{70, 80}, 99.0}};
  const LogLines log;
  const VisionSettings left = preparePoints(settings, info);
  EXPECT_EQ(left.object_points.size(), 2U);
  EXPECT_TRUE(left.not_points.empty());
  EXPECT_EQ(log.count(), 2);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("--object 50,60@2: after the end of the clip, which "
                                          "lasts 2 s; it is left out"),
                                HasSubstr("--not 70,80@99: ")));
  info.frame_count.reset();
  info.live = true;
  EXPECT_EQ(preparePoints(settings, info).object_points.size(), 3U) << "no end is known";
}

TEST(AuthorPoints, ThatContradictEachOtherAreReportedAndSkipped) {
  VisionSettings settings;
  settings.object_points = {{{10, 20}}, {{30, 40}, 1.5}};
  settings.not_points = {{{31, 41}, 1.5}, {{30, 40}, 0.0}};
  const LogLines log;
  const VisionSettings left = preparePoints(settings, {});
  ASSERT_EQ(left.object_points.size(), 1U);
  EXPECT_EQ(left.object_points[0].time_s, 0.0);
  ASSERT_EQ(left.not_points.size(), 1U) << "at another time it is no contradiction";
  EXPECT_EQ(left.not_points[0].time_s, 0.0);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), HasSubstr("--object 30,40@1.5 and --not contradict each other"));
}

}  // namespace
}  // namespace hapticast::server
