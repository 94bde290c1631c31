// SPDX-License-Identifier: MIT
// Key masks of a scene file on any recorded source: their frames, their objects, and refusals.
#include "server/source/folder/key_mask_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/source/synthetic/synthetic_source.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class KeyMaskSourceOfScene : public ::testing::Test {
 protected:
  KeyMaskSourceOfScene() {
    for (int i = 0; i < 5; ++i) {
      const std::string name = std::to_string(i) + ".png";
      folder.write("rgb/" + name, cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(10 * i)));
      folder.write("depth/" + name, cv::Mat(24, 32, CV_16UC1, cv::Scalar(1000)));
    }
  }
  KeyMaskFile draw(int number, double time_s, const cv::Rect& box,
                   const cv::Size& size = {32, 24}) {
    cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
    mask(box).setTo(255);
    const std::string name = std::to_string(++drawn) + ".png";
    folder.write(name, mask);
    return {number, time_s, (folder / name).string()};
  }
  std::unique_ptr<RgbdSource> open(const std::vector<KeyMaskFile>& masks) const {
    return addKeyMasks(openSource(folder.string(), 25.0), masks);
  }
  void refuses(const KeyMaskFile& mask, const std::string& why) const {
    EXPECT_THAT(errorOf([&] { (void)open({mask}); }),
                AllOf(HasSubstr("--scene: key mask " + mask.file), HasSubstr(why)));
  }
  SourceFolder folder;
  int drawn = 0;
};

TEST_F(KeyMaskSourceOfScene, AppearInTheFramesOfTheirTimesInEachRound) {
  const auto source = open(
      {draw(2, 0.04, {1, 1, 4, 4}), draw(1, 0.04, {10, 1, 3, 3}), draw(1, 0.125, {10, 9, 3, 3})});
  EXPECT_TRUE(source->info().key_masks);
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 5; ++i) {
      const auto frame = source->read();
      ASSERT_TRUE(frame);
      ASSERT_EQ(frame->mask.empty(), i != 1 && i != 3) << i;
      if (i == 1) {
        EXPECT_EQ(cv::countNonZero(frame->mask == 2), 16);
        EXPECT_EQ(cv::countNonZero(frame->mask == 1), 9) << "both objects in one frame";
      }
    }
    EXPECT_FALSE(source->read());
    source->rewind();
  }
}

TEST_F(KeyMaskSourceOfScene, ThatDoNotFitAreRefusedWithTheirFile) {
  refuses(draw(1, 0.0, {0, 0, 2, 2}, {16, 12}), "is 16x12, but the pictures are 32x24");
  refuses(draw(1, 0.0, {0, 0, 0, 0}), "shows no object");
  refuses(draw(1, 9.0, {0, 0, 2, 2}), "after the end of the clip, which lasts 0.2 s");
  refuses({1, 0.0, (folder / "none.png").string()}, "mend it");
  folder.write("grey.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar(1, 2, 3)));
  refuses({1, 0.0, (folder / "grey.png").string()}, "white on black");
}

TEST_F(KeyMaskSourceOfScene, FitOnlyRecordedSourcesWithoutMasksOfTheirOwn) {
  EXPECT_THAT(errorOf([&] {
                (void)addKeyMasks(std::make_unique<SyntheticSource>(SceneKind::kStill),
                                  {draw(1, 0.0, {0, 0, 2, 2}, {640, 480})});
              }),
              HasSubstr("has masks of its own for all frames"));
}

}  // namespace
}  // namespace hapticast::server
