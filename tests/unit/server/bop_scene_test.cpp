// SPDX-License-Identifier: MIT
// Folders in the layout of the BOP benchmark: cameras, scales and masks of each image.
#include "server/source/folder/bop_scene.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Images 3 and 7, with two objects, of which the second is missing in image 7.
class BopScene : public testing::Test {
 protected:
  BopScene() {
    for (const char* name : {"000003.png", "000007.png"}) {
      folder.write(std::string("rgb/") + name, cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(90)));
      folder.write(std::string("depth/") + name, cv::Mat(24, 32, CV_16UC1, cv::Scalar(8000)));
    }
    writeCameras(0.1, 0.1);
    for (const char* masks : {"mask", "mask_visib"}) {
      const int wide = std::string(masks) == "mask" ? 12 : 6;
      drawMask(fmt::format("{}/000003_000000.png", masks), {0, 0, wide, 5});
      drawMask(fmt::format("{}/000003_000001.png", masks), {20, 10, wide, 5});
      drawMask(fmt::format("{}/000007_000000.png", masks), {1, 1, wide, 5});
    }
  }
  void writeCameras(double first, double second, double other_fx = 600.0) const {
    folder.write("scene_camera.json",
                 fmt::format(R"({{"3": {{"cam_K": [600.0, 0, 15.5, 0, 601, 11.5, 0, 0, 1],
                                         "depth_scale": {}, "cam_R_w2c": [1, 0, 0]}},
                                 "7": {{"cam_K": [{}, 0, 15.5, 0, 601, 11.5, 0, 0, 1],
                                         "depth_scale": {}}}}})",
                             first, other_fx, second));
  }
  void drawMask(const std::string& name, const cv::Rect& object) const {
    cv::Mat mask = cv::Mat::zeros(24, 32, CV_8UC1);
    mask(object).setTo(255);
    folder.write(name, mask);
  }
  SourceFolder folder;
};

TEST_F(BopScene, HasDepthInMmTheCameraAndTheVisibleMasks) {
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  ASSERT_TRUE(source.info().camera);
  EXPECT_EQ(source.info().camera->fx_px, 600.0);
  EXPECT_EQ(source.info().camera->cy_px, 12.0) << "half a pixel: the image frame's centres";
  EXPECT_FALSE(source.info().key_masks);
  const auto first = source.read();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->depth.at<float>(3, 4), 800.0F);
  EXPECT_EQ(cv::countNonZero(first->mask == 1), 30);
  EXPECT_EQ(cv::countNonZero(first->mask(cv::Rect(20, 10, 6, 5)) == 2), 30);
  const auto second = source.read();
  ASSERT_TRUE(second);
  EXPECT_EQ(cv::countNonZero(second->mask == 1), 30);
  EXPECT_EQ(cv::countNonZero(second->mask == 2), 0);
  EXPECT_EQ(log.count(), 0) << log.text();
  std::filesystem::remove_all(folder / "mask_visib");
  EXPECT_EQ(cv::countNonZero(ImageSequence(folder.string(), 0.0).read()->mask == 1), 60)
      << "whole masks where there are no visible ones";
}

TEST_F(BopScene, EachImageHasItsScale) {
  writeCameras(0.1, 0.2);
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.read()->depth.at<float>(3, 4), 800.0F);
  EXPECT_EQ(source.read()->depth.at<float>(3, 4), 1600.0F);
}

TEST_F(BopScene, DifferentCamerasAndTooManyObjectsAreReported) {
  writeCameras(0.1, 0.1, 900.0);
  drawMask("mask_visib/000003_000016.png", {1, 1, 4, 4});
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  EXPECT_THAT(log.text(), AllOf(HasSubstr("its images have different cameras"),
                                HasSubstr("has more than 16 objects in an image")));
  EXPECT_EQ(log.count(), 2);
}

TEST_F(BopScene, WrongFilesAreRefusedInOneLine) {
  const auto refusal = [this](const std::string& text) {
    folder.write("scene_camera.json", text);
    return openError(folder.string());
  };
  EXPECT_THAT(refusal("{\"3\": 1"), HasSubstr("scene_camera.json:1:8: is no JSON from here on"));
  EXPECT_THAT(refusal("{\"a\": {}}"), HasSubstr("is not the camera of an image"));
  EXPECT_THAT(refusal("{\"3\": {}}"),
              HasSubstr("scene_camera.json:1:2: 'cam_K' is missing; expected are 9 numbers"));
  EXPECT_THAT(refusal(R"({"3": {"cam_K": [1, 0, 0, 0, "x", 0, 0, 0, 1]}})"),
              HasSubstr("'cam_K' is no list of 9 numbers"));
  EXPECT_THAT(refusal(R"({"3": {"cam_K": [0, 0, 0, 0, 0, 0, 0, 0, 1]}})"),
              HasSubstr("no focal length"));
  EXPECT_THAT(refusal(R"({"3": {"cam_K": [9, 0, 0, 0, 9, 0, 0, 0, 1], "depth_scale": 0}})"),
              HasSubstr("'depth_scale' is no number from 0.001 to 1000"));
  EXPECT_THAT(refusal(R"({"3": {"cam_K": [9, 0, 0, 0, 9, 0, 0, 0, 1]}})"),
              HasSubstr("has no camera for 000007.png"));
  writeCameras(0.1, 0.1);
  folder.write("mask_visib/000003_000001.png", cv::Mat(12, 16, CV_8UC1, cv::Scalar(255)));
  EXPECT_THAT(openError(folder.string()),
              HasSubstr("000003_000001.png: is 16x12, but the clip's colour is 32x24"));
}

}  // namespace
}  // namespace hapticast::server
