// SPDX-License-Identifier: MIT
// Pictures that are larger than a stream allows: every kind of source scales them, and the author's
// points, key masks and intrinsics count in the pixels of the author's own pictures.
#include "server/source/scale/picture_scale.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/pipeline/clip_scan.hpp"
#include "server/preview/picture_axes.hpp"
#include "server/source/folder/image_sequence.hpp"
#include "server/source/picture/image_file.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(PictureScale, LargerPicturesKeepTheirAspect) {
  EXPECT_EQ(fitSize({1920, 1080}), cv::Size(1920, 1080));
  EXPECT_EQ(fitSize({424, 512}), cv::Size(424, 512));
  EXPECT_EQ(fitSize({3840, 2160}), cv::Size(1920, 1080));
  EXPECT_EQ(fitSize({1080, 1920}), cv::Size(608, 1080));
  EXPECT_EQ(fitSize({2160, 3840}), cv::Size(608, 1080));
  EXPECT_EQ(fitSize({1920, 1440}), cv::Size(1440, 1080));
  EXPECT_EQ(fitSize({8192, 1}), cv::Size(1920, 1));
}

TEST(PictureScale, SizesThatAreRead) {
  EXPECT_TRUE(sizeReadable(7680, 4320));
  EXPECT_TRUE(sizeReadable(4320, 8192));
  EXPECT_FALSE(sizeReadable(8193, 1));
  EXPECT_FALSE(sizeReadable(8192, 8192));
  EXPECT_FALSE(sizeReadable(0, 5));
  EXPECT_FALSE(sizeReadable(4294967295, 4294967295));
}

/// A clip of two frames: a white square of half the height in the middle, 800 mm before 1600 mm.
class PictureScaleLarge : public testing::Test {
 protected:
  static cv::Rect squareIn(cv::Size size) {
    return {size.width / 4, size.height / 4, size.width / 2, size.height / 2};
  }
  static cv::Mat draw(cv::Size size, int type, double inside, double outside) {
    cv::Mat picture(size, type, cv::Scalar::all(outside));
    picture(squareIn(size)).setTo(cv::Scalar::all(inside));
    return picture;
  }
  void fill(cv::Size size) const {
    for (const char* name : {"0.png", "1.png"}) {
      folder.write(std::string("rgb/") + name, draw(size, CV_8UC3, 255, 0));
      folder.write(std::string("depth/") + name, draw(size, CV_16UC1, 800, 1600));
    }
    folder.write("mask/0.png", draw(size, CV_8UC1, 255, 0));
  }
  void expectSquare(RgbdSource& source, cv::Size size) const {
    ASSERT_EQ(frameSize(source.info()), size);
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    const cv::Rect square = squareIn(size);
    const cv::Rect inside(square.x + 2, square.y + 2, square.width - 4, square.height - 4);
    ASSERT_EQ(frame->color.size(), size);
    ASSERT_EQ(frame->depth.size(), size);
    EXPECT_EQ(cv::countNonZero(frame->depth(inside) != 800.0F), 0);
    EXPECT_EQ(cv::countNonZero((frame->depth != 800.0F) & (frame->depth != 1600.0F)), 0)
        << "no value is mixed";
    EXPECT_NEAR(cv::countNonZero(frame->depth == 800.0F), square.area(), 4.0 * square.width);
    EXPECT_GT(cv::mean(frame->color(inside))[1], 250.0);
    if (!frame->mask.empty()) {
      ASSERT_EQ(frame->mask.size(), size);
      EXPECT_EQ(cv::countNonZero((frame->mask == 1) != (frame->depth == 800.0F)), 0);
    }
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }
  SourceFolder folder;
};

TEST_F(PictureScaleLarge, OfFoldersAreScaledWithMasksAndIntrinsics) {
  const struct {
    cv::Size own, scaled;
  } cases[] = {{{3840, 2160}, {1920, 1080}}, {{1080, 1920}, {608, 1080}}};
  for (const auto& [own, scaled] : cases) {
    SCOPED_TRACE(own);
    fill(own);
    folder.write("meta.json",
                 fmt::format(R"({{"width": {}, "height": {}, "intrinsics": {{"fx": 2000, "fy": 2000,
                             "cx": {}, "cy": {}}}}})",
                             own.width, own.height, 0.5 * own.width - 0.5, 0.5 * own.height - 0.5));
    const LogLines log;
    ImageSequence source(folder.string(), 0.0);
    EXPECT_THAT(log.text(),
                HasSubstr(fmt::format("pictures of {} x {} are scaled to {} x {}", own.width,
                                      own.height, scaled.width, scaled.height)));
    EXPECT_EQ(log.count(), 1) << "meta.json states the size of the pictures";
    expectSquare(source, scaled);
    EXPECT_TRUE(source.info().key_masks);
    ASSERT_TRUE(source.info().camera);
    EXPECT_DOUBLE_EQ(source.info().camera->cx_px, 0.5 * scaled.width);
    EXPECT_DOUBLE_EQ(source.info().camera->fy_px, 2000.0 * scaled.height / own.height);
    while (source.read()) {
    }
    EXPECT_EQ(log.count(), 1) << log.text();
  }
  folder.write("meta.json", std::string(R"({"width": 1920, "height": 1080})"));
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("states 1920x1080, but the pictures are 1080x1920"));
}

TEST_F(PictureScaleLarge, MayHaveSmallerDepth) {
  fill({3840, 2160});
  for (const char* name : {"0.png", "1.png"})
    folder.write(std::string("depth/") + name, draw({960, 540}, CV_16UC1, 800, 1600));
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("depth of 960 x 540 is scaled to 1920 x 1080"));
  expectSquare(source, {1920, 1080});
}

TEST_F(PictureScaleLarge, OfVideosAreScaled) {
  fill({3840, 2160});
  folder.ffmpeg("-i rgb/%d.png -c:v libx264 -preset ultrafast -crf 4 -pix_fmt yuv420p c.mp4");
  folder.ffmpeg("-i depth/%d.png -c:v ffv1 -pix_fmt gray16le d.mkv");
  folder.ffmpeg("-i c.mp4 -i d.mkv -map 0 -map 1 -c copy two.mkv");
  for (const char* spec : {"c.mp4,d.mkv", "two.mkv"}) {
    SCOPED_TRACE(spec);
    const std::string text = spec;
    const std::size_t comma = text.find(',');
    const std::string path = comma == std::string::npos
                                 ? at(text)
                                 : at(text.substr(0, comma)) + "," + at(text.substr(comma + 1));
    const LogLines log;
    const auto source = openSource(path, 0.0);
    EXPECT_THAT(log.text(), HasSubstr("pictures of 3840 x 2160 are scaled to 1920 x 1080"));
    EXPECT_EQ(log.count(), 1) << log.text();
    expectSquare(*source, {1920, 1080});
  }
}

TEST_F(PictureScaleLarge, TwoOf4kSideBySideAreRead) {
  const cv::Size size(3840, 2160);
  cv::Mat both;
  cv::hconcat(draw(size, CV_8UC3, 255, 0), draw(size, CV_8UC3, 200, 40), both);
  folder.write("both.png", both);
  folder.ffmpeg("-i both.png -c:v ffv1 -pix_fmt bgr0 both.mkv");
  const auto source =
      openSource(at("both.mkv"), 0.0, false, {Layout::kSideBySide, DepthCode::kGrey});
  ASSERT_EQ(frameSize(source->info()), cv::Size(1920, 1080));
  const auto frame = source->read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::countNonZero(frame->depth == 200.0F), 960 * 540);
  EXPECT_EQ(cv::countNonZero(frame->depth == 40.0F), 3 * 960 * 540);
}

TEST(AuthorPoints, CountInThePixelsOfTheOwnPictures) {
  SourceInfo info;
  setSize(info, {3840, 2160}, "clip");
  VisionSettings settings;
  settings.object_points = {{{3839, 2159}}, {{100, 50}, 1.0}};
  settings.not_points = {{{8, 4}}};
  const VisionSettings scaled = preparePoints(settings, info);
  EXPECT_EQ(scaled.object_points[0].at_px, Vec2(1919.5, 1079.5));
  EXPECT_EQ(scaled.object_points[1], (AuthorPoint{{50, 25}, 1.0}));
  EXPECT_EQ(scaled.not_points[0].at_px, Vec2(4, 2));
  EXPECT_NO_THROW(Vision(info, scaled));
  settings.object_points = {{{3840, 3}}};
  EXPECT_THAT(errorOf([&] { Vision(info, preparePoints(settings, info)); }),
              HasSubstr("--object 3840,3: outside the picture, which is 3840x2160"));
}

TEST(PictureScaleAxes, NumbersAreThoseOfTheOwnPictures) {
  // The grid of a picture of 3840 x 2160 px that was halved: a line each 200 own px is one each 100
  // px of the frame.
  const cv::Mat black = cv::Mat::zeros(540, 960, CV_8UC3);
  const cv::Mat drawn = drawAxes(black, {0, 0, 960, 540}, {2.0, 2.0});
  const cv::Mat inside = drawn(cv::Rect({kAxisLeft_px, kAxisTop_px}, black.size()));
  for (const int u : {0, 100, 500}) EXPECT_GT(inside.at<cv::Vec3b>(50, u)[0], 0) << u;
  for (const int u : {50, 150, 250}) EXPECT_EQ(inside.at<cv::Vec3b>(50, u)[0], 0) << u;
}

}  // namespace
}  // namespace hapticast::server
