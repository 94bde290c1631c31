// SPDX-License-Identifier: MIT
// Folders with TUM's lists of images: colour and depth associated by time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/server/image_sequence_fixture.hpp"

namespace hapticast::server {
namespace {

using testing::HasSubstr;

class ImageSequenceTum : public ImageSequenceFolder {};

TEST_F(ImageSequenceTum, ListsAreAssociatedByTime) {
  std::string rgb = "# color images\n# timestamp filename\n";
  std::string depth = "# depth maps\r\n";
  for (int i = 0; i < 6; ++i) {
    const std::string name = number(i) + ".png";
    folder.write("rgb/" + name, color(10 * i));
    folder.write("depth/" + name, depth16(5000 + i));
    // Depth 10 ms late; frame 3 is 25 ms late: nearer to colour 4 than 20 ms, but taken there
    // already.
    const auto stamp = [](int ms) {
      return "1305031102." + std::to_string(100000 + ms * 1000).substr(0, 6);
    };
    rgb += stamp(30 * i) + " rgb/" + name + "\n";
    depth += stamp(30 * i + (i == 3 ? 25 : 10)) + "  depth/" + name + "\r\n";
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  ImageSequence source(folder.string(), 0.0);
  EXPECT_NEAR(source.info().fps, 1.0 / 0.03, 0.01);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
  ASSERT_TRUE(source.info().camera) << "a Kinect's";
  EXPECT_NEAR(source.info().camera->fx_px / source.info().width_px, 525.0 / 640.0, 0.001);
  std::vector<int> colors;
  std::vector<float> depths;
  while (const auto frame = source.read()) {
    colors.push_back(frame->color.at<cv::Vec3b>(0, 0)[1] / 10);
    depths.push_back(frame->depth.at<float>(0, 0));
  }
  EXPECT_EQ(colors, (std::vector<int>{0, 1, 2, 4, 5}));
  const std::vector<float> expected{1000.0F, 1000.2F, 1000.4F, 1000.6F, 1001.0F};
  EXPECT_THAT(depths, testing::Pointwise(testing::FloatNear(1e-3F), expected));
}

TEST_F(ImageSequenceTum, BadListsAreRefused) {
  fill();
  folder.write("rgb.txt", std::string("1.0 rgb/000000.png\n"));
  folder.write("depth.txt", std::string("9.0 depth/000000.png\n"));
  EXPECT_THAT(openError(), HasSubstr("within 20 ms"));
  folder.write("depth.txt", std::string("# only\nnonsense\n"));
  EXPECT_THAT(openError(), HasSubstr("depth.txt: line 2 is not"));
  folder.write("depth.txt", std::string("1.0\n"));
  EXPECT_THAT(openError(), HasSubstr("depth.txt: line 1 is not"));
  folder.write("depth.txt", std::string("# nothing\n"));
  EXPECT_THAT(openError(), HasSubstr("lists no frames"));
  folder.write("depth.txt", std::string("1.0 depth/none.png\n"));
  EXPECT_THAT(openError(), HasSubstr("none.png: cannot be read"));
  folder.write("depth/000000.png", depth8(1));
  folder.write("depth.txt", std::string("1.0 depth/000000.png\n"));
  EXPECT_THAT(openError(), HasSubstr("8 bits where 16 are declared"));
}

}  // namespace
}  // namespace hapticast::server
