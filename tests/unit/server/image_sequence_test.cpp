// SPDX-License-Identifier: MIT
// Folders of images as a source: layouts, declarations, every kind of broken folder.
#include "server/source/folder/image_sequence.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/unit/server/image_sequence_fixture.hpp"

namespace hapticast::server {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST_F(ImageSequenceFolder, ReadsFramesInOrder) {
  fill();
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.info().width_px, 32);
  EXPECT_EQ(source.info().height_px, 24);
  EXPECT_EQ(source.info().fps, 25.0);
  EXPECT_EQ(source.info().frame_count, 5U);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
  EXPECT_FALSE(source.info().live);
  EXPECT_FALSE(source.info().camera);
  for (int i = 0; i < 5; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_DOUBLE_EQ(frame->clip_time_s, i / 25.0);
    EXPECT_EQ(frame->color.type(), CV_8UC3);
    EXPECT_EQ(frame->depth.type(), CV_32FC1);
    EXPECT_EQ(frame->depth.at<float>(3, 4), static_cast<float>(1000 + i));
    EXPECT_EQ(frame->color.at<cv::Vec3b>(3, 4)[1], 10 * i);
    EXPECT_TRUE(frame->mask.empty());
  }
  EXPECT_FALSE(source.read());
  EXPECT_FALSE(source.skip());
}

TEST_F(ImageSequenceFolder, OfColourAloneNeedsNoDepth) {
  VideoLayout layout;
  layout.color_only = true;
  for (int i = 0; i < 3; ++i) folder.write("rgb/" + number(i) + ".png", color(10 * i));
  folder.write("mask/" + number(1) + ".png", depth8(1));
  ImageSequence source(folder.string(), 0.0, false, layout);
  EXPECT_TRUE(source.info().key_masks);
  for (int i = 0; i < 3; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->color.at<cv::Vec3b>(0, 0)[1], 10 * i);
    EXPECT_TRUE(frame->depth.empty());
    EXPECT_EQ(frame->mask.empty(), i != 1);
  }
  EXPECT_FALSE(source.read());
}

TEST_F(ImageSequenceFolder, ImagesInTheFolderItselfAreColourAlone) {
  VideoLayout layout;
  layout.color_only = true;
  folder.write("b.png", color(2));
  folder.write("a.png", color(1));
  folder.write("a_depth.png", depth16(900));
  ImageSequence source(folder.string(), 0.0, false, layout);
  EXPECT_EQ(source.info().frame_count, 2U);
  EXPECT_EQ(source.read()->color.at<cv::Vec3b>(0, 0)[1], 1);
}

TEST_F(ImageSequenceFolder, SkipsAndRewindsIntoANewEpoch) {
  fill();
  ImageSequence source(folder.string(), 0.0);
  EXPECT_TRUE(source.skip());
  EXPECT_EQ(source.read()->index, 1U);
  source.rewind();
  const auto frame = source.read();
  EXPECT_EQ(frame->index, 0U);
  EXPECT_EQ(frame->epoch, 1U);
}

TEST_F(ImageSequenceFolder, MetaGivesRateScaleAndCamera) {
  fill();
  folder.write("meta.json",
               R"({"name": null, "x": "caf\u00e9 \"q\"", "tags": [1, {"fps": 3}], "fps": 29.97,
                   "depth_scale_m_per_unit": 0.0005,
                   "intrinsics": {"fx": 600.5, "fy": 601, "cx": 15.5, "cy": 11.5, "model": "p"}})");
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.info().fps, 29.97);
  EXPECT_EQ(source.read()->depth.at<float>(0, 0), 500.0F);
  ASSERT_TRUE(source.info().camera);
  EXPECT_EQ(source.info().camera->fx_px, 600.5);
  EXPECT_EQ(source.info().camera->cx_px, 16.0) << "half a pixel: the image frame's centres";
  EXPECT_EQ(ImageSequence(folder.string(), 60.0).info().fps, 60.0) << "the caller overrides";
}

TEST_F(ImageSequenceFolder, MetaMayGiveTheFieldOfViewInPlaceOfIntrinsics) {
  fill();
  folder.write("meta.json", std::string(R"({"fov_deg": 90})"));
  const ImageSequence source(folder.string(), 0.0);
  ASSERT_TRUE(source.info().camera);
  EXPECT_NEAR(source.info().camera->fx_px, 16.0, 1e-9);
  folder.write("meta.json", std::string(R"({"fov_deg": 5})"));
  EXPECT_THAT(openError(), AllOf(HasSubstr("'fov_deg' is no number"), HasSubstr("from 10 to 170")));
}

TEST_F(ImageSequenceFolder, BadMetaIsRefused) {
  fill();
  folder.write("meta.json", "{\"fps\": 30");
  EXPECT_THAT(openError(), HasSubstr("meta.json:1:11: is no JSON"));
  folder.write("meta.json", "{\"fps\": 0}");
  EXPECT_THAT(openError(), AllOf(HasSubstr("'fps' is no number"), HasSubstr("1 to 240")));
  folder.write("meta.json", "{\"fps\": \"fast\"}");
  EXPECT_THAT(openError(), HasSubstr("'fps' is no number"));
  folder.write("meta.json", "{\"depth_scale_m_per_unit\": -1}");
  EXPECT_THAT(openError(), HasSubstr("depth_scale_m_per_unit"));
  folder.write("meta.json", "{\"a\": " + std::string(1000, '['));
  EXPECT_THAT(openError(), HasSubstr("has more than 32 levels"));
}

TEST_F(ImageSequenceFolder, EightBitDepthOfAPlainFolderIsHeight) {
  for (int i = 0; i < 3; ++i) {
    folder.write("color/frame" + std::to_string(9 + i) + ".jpg", color(100));
    folder.write("depth/d" + std::to_string(9 + i) + ".png", depth8(50 * i));
  }
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kHeight);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(source.read()->depth.at<float>(0, 0), static_cast<float>(50 * i))
        << "9, 10, 11 in order";
  }
}

TEST_F(ImageSequenceFolder, GreyDepthWithThreeChannelsIsHeightButColoursAreRefused) {
  folder.write("rgb/a.png", color(100));
  folder.write("depth/a.png", color(77));
  EXPECT_EQ(ImageSequence(folder.string(), 0.0).read()->depth.at<float>(0, 0), 77.0F);
  folder.write("depth/a.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar(255, 128, 0)));
  EXPECT_THAT(openError(), HasSubstr("shows depth as colours"));
}

TEST_F(ImageSequenceFolder, EightBitDepthWhereSixteenIsDeclaredIsRefused) {
  folder.write("rgb/000000.png", color(1));
  folder.write("depth/000000.png", depth8(1));
  for (const char* meta : {R"({"depth": "depth/%06d.png 16-bit, millimetres"})",
                           R"({"depth_scale_m_per_unit": 0.001})", R"({"depth_bits": 16})"}) {
    folder.write("meta.json", std::string(meta));
    EXPECT_THAT(openError(),
                AllOf(HasSubstr("depth/000000.png: depth has 8 bits where 16 are declared"),
                      HasSubstr("save it as 16-bit")));
  }
  for (const char* meta : {R"({"depth": "8-bit, near is white"})", R"({"depth_bits": 8})"}) {
    folder.write("meta.json", std::string(meta));
    EXPECT_EQ(ImageSequence(folder.string(), 0.0).info().depth_kind, DepthKind::kHeight);
  }
  folder.write("depth/000000.png", depth16(1));
  EXPECT_THAT(openError(), HasSubstr("16 bits where 8 are declared"));
}

TEST_F(ImageSequenceFolder, MasksNumberObjects) {
  fill(3);
  cv::Mat mask = cv::Mat::zeros(24, 32, CV_8UC1);
  mask.at<std::uint8_t>(1, 1) = 2;
  folder.write("mask/000000.png", mask);
  mask.at<std::uint8_t>(1, 1) = 255;
  mask.at<std::uint8_t>(2, 2) = 90;
  folder.write("mask/000001.png", mask);
  folder.write("mask/000002.png", color(1));
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.read()->mask.at<std::uint8_t>(1, 1), 2);
  const auto white = source.read();
  EXPECT_EQ(white->mask.at<std::uint8_t>(1, 1), 1) << "black and white: object 1";
  EXPECT_EQ(white->mask.at<std::uint8_t>(2, 2), 0);
  const LogLines log;
  EXPECT_FALSE(source.read());
  EXPECT_THAT(log.text(), HasSubstr("mask/000002.png: is not an 8-bit grey image"));
}

TEST_F(ImageSequenceFolder, MissingParts) {
  EXPECT_THAT(errorOf([this] { ImageSequence(folder.string() + "/none", 0.0); }),
              HasSubstr("/none: no such folder"));
  EXPECT_THAT(openError(), AllOf(HasSubstr("is empty"), HasSubstr("rgb/")));
  folder.write("notes.txt", std::string("x"));
  EXPECT_THAT(openError(), HasSubstr("no folder rgb/ or color/"));
  fs::create_directories(folder / "rgb");
  EXPECT_THAT(openError(), HasSubstr("no folder depth/"));
  fs::create_directories(folder / "depth");
  EXPECT_THAT(openError(), HasSubstr("rgb: has no PNG, JPEG, WebP, BMP or PPM images"));
}

TEST_F(ImageSequenceFolder, AnotherCountOfDepthOrMaskIsRefused) {
  fill();
  fs::rename(folder / "depth", folder / "aside");
  for (const char* name : {"a", "b", "c", "d"})
    folder.write("depth/" + std::string(name) + ".png", depth16(1));
  EXPECT_THAT(openError(), HasSubstr("depth: 4 images, but there are 5 colour images"))
      << "no numbers to pair them by";
  fs::remove_all(folder / "depth");
  fs::rename(folder / "aside", folder / "depth");
  for (int i = 0; i < 6; ++i) folder.write("mask/" + number(i) + ".png", depth8(1));
  EXPECT_THAT(openError(), HasSubstr("mask: 6 images, but there are 5 colour images"));
}

TEST_F(ImageSequenceFolder, DepthOfAnotherSizeIsRefusedAtTheStartAndLeftOutLater) {
  fill();
  folder.write("depth/000002.png", depth16(7, {16, 12}));
  ImageSequence source(folder.string(), 0.0);
  const LogLines log;
  EXPECT_EQ(source.read()->index, 0U);
  EXPECT_EQ(source.read()->index, 1U);
  EXPECT_EQ(source.read()->index, 3U);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("000002.png: is 16x12, but the clip's colour is 32x24"),
                                HasSubstr("frame 2 is left out")));
  folder.write("depth/000000.png", depth16(7, {16, 16}));
  EXPECT_THAT(openError(), HasSubstr("depth/000000.png: is 16x16"));
}

TEST_F(ImageSequenceFolder, InverseDepthIsNearWhereItIsDark) {
  fill();
  EXPECT_THROW(ImageSequence(folder.string(), 0.0, false, {Layout::kSeparate, DepthCode::kInverse}),
               SourceError)
      << "depth in mm has no code";
  for (int i = 0; i < 5; ++i) {
    cv::Mat depth(24, 32, CV_8UC1, cv::Scalar(200));
    depth.colRange(0, 16).setTo(10);
    folder.write("depth/" + number(i) + ".png", depth);
  }
  ImageSequence source(folder.string(), 0.0, false, {Layout::kSeparate, DepthCode::kInverse});
  ASSERT_EQ(source.info().depth_kind, DepthKind::kHeight);
  const auto frame = source.read();
  EXPECT_EQ(cv::countNonZero(frame->depth == 245.0F), 16 * 24);
  EXPECT_EQ(cv::countNonZero(frame->depth == 55.0F), 16 * 24);
}

TEST_F(ImageSequenceFolder, SmallerDepthOfTheSameAspectIsScaled) {
  fill();
  for (int i = 0; i < 5; ++i) {
    cv::Mat depth = depth16(800, {16, 12});
    depth.colRange(8, 16).setTo(i == 0 ? 0 : 1600);
    folder.write("depth/" + number(i) + ".png", depth);
  }
  folder.write("depth/000003.png", depth16(7));
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  EXPECT_THAT(log.text(), HasSubstr("depth of 16 x 12 is scaled to 32 x 24"));
  const auto frame = source.read();
  EXPECT_EQ(frame->depth.size(), cv::Size(32, 24));
  EXPECT_EQ(cv::countNonZero(frame->depth == 800.0F), 16 * 24) << "no value at the edge is mixed";
  EXPECT_EQ(cv::countNonZero(frame->depth == 0.0F), 16 * 24);
  int rest = 0;
  while (source.read()) ++rest;
  EXPECT_EQ(rest, 3);
  EXPECT_THAT(log.text(), HasSubstr("000003.png: is 32x24, but the clip's depth is 16x12"));
  EXPECT_EQ(log.count(), 2) << log.text();
}

TEST_F(ImageSequenceFolder, UnreadableImagesInTheMiddleAreLeftOutWithOneWarningEach) {
  fill();
  folder.write("depth/000001.png", std::string("this is no image"));
  std::ifstream in(folder / "rgb/000003.png", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  folder.write("rgb/000003.png", bytes.substr(0, bytes.size() / 2));
  ImageSequence source(folder.string(), 0.0);
  const LogLines log;
  EXPECT_EQ(source.read()->index, 0U);
  EXPECT_EQ(source.read()->index, 2U);
  EXPECT_EQ(log.count(), 1);
  const auto last = source.read();
  EXPECT_EQ(last->index, 4U);
  EXPECT_DOUBLE_EQ(last->clip_time_s, 4 / 25.0);
  EXPECT_EQ(log.count(), 2);
  EXPECT_FALSE(source.read());
  source.rewind();
  while (source.read()) {
  }
  EXPECT_EQ(log.count(), 2) << "not again in every loop";
  EXPECT_THAT(log.text(), AllOf(HasSubstr("000001.png: is not a whole PNG, JPEG, WebP"),
                                HasSubstr("000003.png: is cut off")));
}

TEST_F(ImageSequenceFolder, AnotherKindOfDepthInTheMiddleIsLeftOut) {
  fill();
  folder.write("depth/000001.png", depth8(3));
  fs::remove(folder / "depth/000002.png");
  fs::create_directories(folder / "depth/000002.png");  // a folder with an image's name
  ImageSequence source(folder.string(), 0.0);
  const LogLines log;
  EXPECT_EQ(source.read()->index, 0U);
  EXPECT_EQ(source.read()->index, 3U);
  EXPECT_EQ(log.count(), 1) << "one line for a run of them";
  EXPECT_THAT(log.text(),
              AllOf(HasSubstr("000001.png: "), HasSubstr("frames 1 to 2 are left out")));
}

TEST_F(ImageSequenceFolder, FilesThatVanishEndItInOneLineWhereNoneIsLeft) {
  fill();
  ImageSequence source(folder.string(), 0.0);
  const LogLines log;
  EXPECT_EQ(source.read()->index, 0U);
  fs::remove_all(folder / "rgb");
  EXPECT_THAT(errorOf([&] { (void)source.read(); }),
              AllOf(HasSubstr("rgb/000001.png: cannot be read"), HasSubstr("put the files back")))
      << "although of this round there was one";
  source.rewind();
  EXPECT_THAT(errorOf([&] { (void)source.read(); }),
              AllOf(HasSubstr("rgb/000000.png: cannot be read"), HasSubstr("put the files back")));
  EXPECT_EQ(log.count(), 0) << "the error says it";
}

TEST_F(ImageSequenceFolder, AnUnreadableFirstFrameIsRefused) {
  fill();
  folder.write("depth/000000.png", std::string("x"));
  EXPECT_THAT(openError(), HasSubstr("depth/000000.png: is not a whole PNG, JPEG, WebP"));
  folder.write("rgb/000000.png", std::string());
  EXPECT_THAT(openError(), HasSubstr("rgb/000000.png: is empty"));
}

TEST_F(ImageSequenceFolder, TooLargeImagesAreRefusedBeforeTheyAreDecoded) {
  fill();
  folder.write("rgb/000000.png", color(0, {8200, 24}));
  EXPECT_THAT(openError(), HasSubstr("000000.png: is 8200x24, larger than 8192 px a side"));
  // A PNG header that promises 60000 x 60000 pixels, and nothing behind it.
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xea\x60\0\0\xea\x60\x08\x02\0\0\0", 29);
  folder.write("rgb/000000.png", png);
  EXPECT_THAT(openError(), HasSubstr("is 60000x60000, larger than"));
  fs::remove(folder / "rgb/000000.png");
  folder.write("rgb/000000.jpg", color(0, {64, 8200}));
  EXPECT_THAT(openError(), HasSubstr("000000.jpg: is 64x8200, larger than"));
}

}  // namespace
}  // namespace hapticast::server
