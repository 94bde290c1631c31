// SPDX-License-Identifier: MIT
// Cameras as a source: what is said where there is none (a test machine has none).
#include "server/source/camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Camera, AMissingDeviceIsNamed) {
  EXPECT_THAT(openError("camera:91,92"),
              AllOf(HasSubstr("/dev/video91: no such camera"), HasSubstr("are /dev/video*")));
}

TEST(Camera, DepthIsAskedFor) {
  EXPECT_THAT(openError("camera:3"), AllOf(HasSubstr("depth is needed"), HasSubstr("camera:3,M")));
}

TEST(Camera, NumbersAreChecked) {
  for (const char* spec : {"camera:", "camera:x", "camera:-1,2", "camera:1,", "camera:1,2,3",
                           "camera:1,2x", "camera:99999999999,1"}) {
    EXPECT_THAT(openError(spec), AllOf(HasSubstr(spec), HasSubstr("is not a camera number")))
        << spec;
  }
}

/// A capture that gives grey pictures of the given sizes; the last size repeats.
class FakeCapture final : public cv::VideoCapture {
 public:
  FakeCapture(int type, std::vector<cv::Size> sizes) : type_(type), sizes_(std::move(sizes)) {}
  bool grab() override { return true; }
  bool retrieve(cv::OutputArray image, int /*flag*/) override {
    image.assign(cv::Mat(sizes_[std::min(next_++, sizes_.size() - 1)], type_, cv::Scalar::all(90)));
    return true;
  }
  bool read(cv::OutputArray image) override { return grab() && retrieve(image, 0); }
  bool set(int /*property*/, double /*value*/) override { return true; }
  [[nodiscard]] double get(int /*property*/) const override { return 30.0; }

 private:
  int type_;
  std::vector<cv::Size> sizes_;
  std::size_t next_ = 0;
};

Camera selectCamera(std::vector<cv::Size> colors, std::vector<cv::Size> depths) {
  return {{std::make_unique<FakeCapture>(CV_8UC3, std::move(colors)), "/dev/video7"},
          {std::make_unique<FakeCapture>(CV_16UC1, std::move(depths)), "/dev/video8"},
          0.0};
}

const cv::Size kSize(64, 48);
const cv::Size kOther(32, 24);

TEST(Camera, AFrameOfAnotherSizeIsLeftOutWithOneWarning) {
  Camera camera = selectCamera({kSize, kSize, kOther, kSize}, {kSize});
  const LogLines log;
  EXPECT_EQ(camera.read()->index, 0U);
  EXPECT_EQ(camera.read()->index, 2U);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), HasSubstr("/dev/video7: delivers 32x24, but began with 64x48; frame 1"));
}

TEST(Camera, OneThatFailsNowAndThenDoesNotFillTheLog) {
  std::vector<cv::Size> sizes;
  sizes.reserve(201);
  for (int i = 0; i < 200; ++i) sizes.push_back(i % 2 == 1 ? kOther : kSize);
  sizes.push_back(kSize);
  Camera camera = selectCamera(sizes, {kSize});
  const LogLines log;
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(camera.read());
  EXPECT_GE(log.count(), 2);
  EXPECT_LE(log.count(), 8) << log.text();
}

TEST(Camera, FramesThatStayOfAnotherSizeEndItInOneLine) {
  Camera camera = selectCamera({kSize}, {kSize, kSize, kOther});
  const LogLines log;
  EXPECT_TRUE(camera.read());
  EXPECT_THAT(errorOf([&] { (void)camera.read(); }),
              HasSubstr("/dev/video8: delivers 32x24, but began with 64x48, 25 frames in a row"));
  EXPECT_EQ(log.count(), 1) << log.text();
}

}  // namespace
}  // namespace hapticast::server
