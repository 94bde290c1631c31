// SPDX-License-Identifier: MIT
// Objects that the author described in a scene: each has its own material, whichever segmenter
// finds it, and keeps it under a new id.
#include <gtest/gtest.h>

#include <map>
#include <opencv2/imgproc.hpp>

#include "server/vision/vision.hpp"

namespace hapticast::server {
namespace {

constexpr int kWidth_px = 160;
constexpr int kHeight_px = 120;

/// A red disc on the left and a green one on the right, 100 mm before a wall.
RgbdFrame drawFrame(std::uint64_t index, bool left_is_there, bool masks) {
  RgbdFrame frame;
  frame.index = index;
  frame.clip_time_s = double(index) / 25.0;
  frame.color = cv::Mat(kHeight_px, kWidth_px, CV_8UC3, cv::Scalar(90, 90, 90));
  frame.depth = cv::Mat(kHeight_px, kWidth_px, CV_32FC1, cv::Scalar(700));
  cv::Mat labels = cv::Mat::zeros(kHeight_px, kWidth_px, CV_8UC1);
  const auto add = [&](const cv::Point& at, const cv::Scalar& color, int label) {
    cv::circle(frame.color, at, 20, color, cv::FILLED);
    cv::circle(frame.depth, at, 20, cv::Scalar(600), cv::FILLED);
    cv::circle(labels, at, 20, cv::Scalar(label), cv::FILLED);
  };
  if (left_is_there) add({40, 60}, {40, 40, 200}, 2);
  add({115, 60}, {40, 200, 40}, 1);
  if (masks) frame.mask = labels;
  return frame;
}

VisionSettings settingsWithTwo() {
  VisionSettings settings;
  settings.object_points = {{{40, 60}, 0.0, 1}, {{35, 55}, 0.0, 1}, {{115, 60}, 0.0, 2}};
  settings.objects = {{"red", {}}, {"green", {}}};
  settings.objects[0].material.stiffness_N_mm = 0.3;
  settings.objects[1].material.mass_kg = 2.0;
  settings.map_range = DepthRange{500, 800};
  settings.low_latency = true;
  return settings;
}

/// Materials by name, from each frame of a clip in which the left disc is absent for a while.
std::map<std::string, std::vector<Material>> playClip(const VisionSettings& settings, bool masks) {
  SourceInfo info;
  info.name = "discs";
  info.width_px = kWidth_px;
  info.height_px = kHeight_px;
  info.frame_count = 60;
  Vision vision(info, settings);
  std::map<std::string, std::vector<Material>> out;
  std::uint32_t largest_id = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    const bool left_is_there = i < 15 || i >= 30;
    const auto result = vision.push(drawFrame(i, left_is_there, masks),
                                    MediaTime{} + fromSeconds(double(i) / 25.0));
    if (!result) continue;
    for (const HapticObject& object : result->frame.objects) {
      out[vision.name(object.id)].push_back(object.material);
      largest_id = std::max(largest_id, object.id);
    }
  }
  if (masks) {
    EXPECT_EQ(largest_id, 3U) << "the left disc came back under a new id";
  }
  return out;
}

class AuthorObjects : public ::testing::TestWithParam<bool> {};

TEST_P(AuthorObjects, HaveTheirOwnMaterialAlsoAfterALoss) {
  const VisionSettings settings = settingsWithTwo();
  const auto materials = playClip(settings, GetParam());
  ASSERT_EQ(materials.size(), 2U) << "each object has the name of its points";
  for (const Material& material : materials.at("red"))
    EXPECT_EQ(material, settings.objects[0].material);
  for (const Material& material : materials.at("green"))
    EXPECT_EQ(material, settings.objects[1].material);
  EXPECT_GT(materials.at("red").size(), 35U);
}

INSTANTIATE_TEST_SUITE_P(BandOrMasksOfTheSource, AuthorObjects, ::testing::Bool());

TEST(AuthorObjectsErrors, APointOutsideThePictureNamesFileAndObject) {
  VisionSettings settings = settingsWithTwo();
  settings.scene_file = "s.json";
  settings.object_points[2].at_px = {900, 3};
  SourceInfo info;
  info.width_px = kWidth_px;
  info.height_px = kHeight_px;
  try {
    const Vision vision(info, settings);
    FAIL();
  } catch (const SourceError& error) {
    EXPECT_EQ(std::string(error.what()),
              "--scene s.json: object 'green', point 900,3: outside the picture, which is 160x120; "
              "use u,v in pixels from its top-left corner");
  }
}

}  // namespace
}  // namespace hapticast::server
