// SPDX-License-Identifier: MIT
// --preview: the pictures are there and show what was taken; places that cannot be written to; the
// author's points after the end of a clip.
#include "server/preview/preview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/pipeline/clip_scan.hpp"
#include "server/preview/correction_hint.hpp"
#include "server/source/synthetic_source.hpp"
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
  ASSERT_EQ(picture.cols, 2 * frame->color.cols);
  ASSERT_GT(picture.rows, frame->color.rows) << "lines of text below";
  const cv::Rect left({0, 0}, frame->color.size());
  cv::Mat changed;
  cv::absdiff(picture(left), frame->color, changed);
  cv::transform(changed, changed, cv::Matx13f(1, 1, 1));
  const cv::Mat mask = frame->mask > 0;
  const cv::Mat rim = mask & ~erodedBy(mask, 1);
  EXPECT_EQ(cv::countNonZero(rim & (changed == 0)), 0) << "a gap in the outline";
  EXPECT_EQ(cv::countNonZero(~dilatedBy(mask, 6) & (changed > 0)), 0) << "drawn elsewhere";
  cv::Mat relief;
  cv::cvtColor(picture(left + cv::Point(left.width, 0)), relief, cv::COLOR_BGR2GRAY);
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

TEST_F(Preview, PlacesThatCannotBeWrittenToAreToldInOneLine) {
  folder.write("file", std::string("x"));
  const auto refusal = [&](const char* place) {
    return errorOf([&] { (void)run(settingsFor(place)); });
  };
  EXPECT_THAT(refusal("file/below"), AllOf(HasSubstr("--preview "), HasSubstr("is not a folder")));
  EXPECT_THAT(refusal("none/a.png"), AllOf(HasSubstr("--preview "), HasSubstr("be written")));
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_F(Preview, WhatCannotBeStartedOnIsTheUsualLine) {
  Settings settings = settingsFor("a.png");
  settings.vision.object_points = {{{2, 2}}};
  EXPECT_THAT(errorOf([&] { (void)run(settings); }), HasSubstr("--object 2,2"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

TEST(PreviewAdvice, PointsAtTheHandThatTheMaskHolds) {
  cv::Mat color(240, 320, CV_8UC3, cv::Scalar(60, 60, 60));
  cv::Mat mask = cv::Mat::zeros(color.size(), CV_8UC1);
  cv::circle(color, {150, 120}, 40, {60, 120, 60}, cv::FILLED);
  cv::circle(mask, {150, 120}, 40, cv::Scalar(255), cv::FILLED);
  EXPECT_FALSE(suggestCorrection(color, mask)) << "one colour, no edge";
  const cv::Rect hand(185, 100, 50, 30);
  color(hand).setTo(cv::Scalar(120, 150, 210));
  mask(hand).setTo(255);
  const auto doubt = suggestCorrection(color, mask);
  ASSERT_TRUE(doubt);
  EXPECT_TRUE(hand.contains(doubt->at_px)) << doubt->at_px;
  EXPECT_THAT(doubt->why, HasSubstr("skin"));
  mask(cv::Rect(185, 100, 135, 30)).setTo(255);
  const auto arm = suggestCorrection(color, mask);
  ASSERT_TRUE(arm);
  EXPECT_GT(arm->at_px.x, 300);
  EXPECT_THAT(arm->why, HasSubstr("edge"));
}

TEST(AuthorPoints, AfterTheEndOfTheClipAreToldAndLeftOut) {
  SourceInfo info;
  info.fps = 25.0;
  info.frame_count = 50;
  VisionSettings settings;
  settings.object_points = {{{10, 20}}, {{30, 40}, 1.96}, {{50, 60}, 2.0}};
  settings.not_points = {{{70, 80}, 99.0}};
  const LogLines log;
  const VisionSettings left = dropInvalidPoints(settings, info);
  EXPECT_EQ(left.object_points.size(), 2U);
  EXPECT_TRUE(left.not_points.empty());
  EXPECT_EQ(log.count(), 2);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("--object 50,60@2: after the end of the clip, which "
                                          "lasts 2 s; it is left out"),
                                HasSubstr("--not 70,80@99: ")));
  info.frame_count.reset();
  info.live = true;
  EXPECT_EQ(dropInvalidPoints(settings, info).object_points.size(), 3U) << "no end is known";
}

TEST(AuthorPoints, ThatContradictEachOtherAreToldAndLeftOut) {
  VisionSettings settings;
  settings.object_points = {{{10, 20}}, {{30, 40}, 1.5}};
  settings.not_points = {{{31, 41}, 1.5}, {{30, 40}, 0.0}};
  const LogLines log;
  const VisionSettings left = dropInvalidPoints(settings, {});
  ASSERT_EQ(left.object_points.size(), 1U);
  EXPECT_EQ(left.object_points[0].time_s, 0.0);
  ASSERT_EQ(left.not_points.size(), 1U) << "at another time it is no contradiction";
  EXPECT_EQ(left.not_points[0].time_s, 0.0);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), HasSubstr("--object 30,40@1.5 and --not contradict each other"));
}

}  // namespace
}  // namespace hapticast::server
