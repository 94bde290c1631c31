// SPDX-License-Identifier: MIT
// A camera of two nodes, with emulated calls to the kernel (kernel.hpp). In real time: everything
// waits for conditions. No real node has been read yet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <string>

#include "server/source/live/v4l2_picture.hpp"
#include "tests/support/live_source.hpp"
#include "tests/support/process.hpp"
#include "tests/unit/server/source_files.hpp"
#include "tests/v4l2/kernel.hpp"

namespace hapticast::server {
namespace {

using ::testing::HasSubstr;
using testing::NodeOrders;
constexpr std::chrono::seconds kSoon{60};
const std::string kSpec = std::string("v4l2:") + testing::kColorNode + "," + testing::kDepthNode;

class V4l2Camera : public ::testing::Test {
 protected:
  V4l2Camera() {
    color_.codes = {fourCc("GREY"), fourCc("YUYV")};
    depth_.codes = {fourCc("INZI"), fourCc("Z16 ")};
    order();
  }
  void order() const { testing::orderNodes(color_, depth_); }

  NodeOrders color_;
  NodeOrders depth_;
};

/// Expects a frame whose colour and depth are of one moment, and the same in every pixel.
void expectWhole(const RgbdFrame& frame) {
  double least = 0.0, most = 0.0;
  cv::minMaxLoc(frame.depth, &least, &most);
  EXPECT_EQ(least, most);
  const auto number = static_cast<std::uint64_t>(least) - 1000;
  EXPECT_EQ(testing::depthOf_mm(number), least);
  const double grey = (testing::brightnessOf(number) - 16) * 255.0 / 219.0;
  for (const cv::Point at : {cv::Point(0, 0), cv::Point(frame.color.size()) - cv::Point(1, 1)}) {
    const auto pixel = frame.color.at<cv::Vec3b>(at);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(pixel[channel], grey, 1.5);
  }
}

TEST_F(V4l2Camera, ColourAndDepthAreOfOneMoment) {
  const LogLines log;
  const auto source = openSource(kSpec, 0.0);
  EXPECT_EQ(source->info().name, "v4l2:video-test-color,video-test-depth");
  EXPECT_EQ(cv::Size(source->info().width_px, source->info().height_px), cv::Size(64, 48));
  EXPECT_EQ(source->info().fps, double{testing::kNodeFps});
  EXPECT_TRUE(source->info().live);
  for (int i = 0; i < 10; ++i) {
    const auto frame = testing::readLive(*source);
    ASSERT_TRUE(frame);
    expectWhole(*frame);
  }
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), HasSubstr("depth is not registered to colour"));
}

TEST_F(V4l2Camera, ASlowReaderGetsTheNewestFrame) {
  const auto source = openSource(kSpec, 0.0);
  for (int i = 0; i < 3; ++i) {
    // More frames than buffers.
    EXPECT_TRUE(waitUntil(
        kSoon, [last = testing::nodeFrames()] { return testing::nodeFrames() > last + 7; }));
    const auto frame = testing::readLive(*source);
    ASSERT_TRUE(frame);
    expectWhole(*frame);
  }
}

TEST_F(V4l2Camera, RowsMayHaveGapsAndDepthMayBeSmaller) {
  color_.gap_bytes = 12;
  depth_.gap_bytes = 6;
  depth_.width_px = 32;
  depth_.height_px = 24;
  order();
  const auto frame = testing::readLive(*openSource(kSpec, 0.0));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->depth.size(), cv::Size(64, 48));
  expectWhole(*frame);
}

TEST_F(V4l2Camera, AWrongStartIsOneLine) {
  color_.codes = {fourCc("GREY")};
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("test-color: delivers no colour"));
  color_.codes = depth_.codes = {fourCc("YUYV")};
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("test-depth: delivers no depth (Z16, Y16 or grey)"));
  depth_.codes = {fourCc("Y16 ")};
  depth_.height_px = 64;
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("delivers 64x64, another shape than"));
  depth_.height_px = 48;
  color_.width_px = 5000;
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("test-color: delivers 5000x48; allowed is"));
  color_.width_px = 64;
  depth_.used_bytes = 100;
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("test-depth: delivers 100 bytes instead of 6144"));
  depth_.used_bytes = 0;
  depth_.delivers = false;
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("delivers no depth pictures"));
  depth_.plugged = false;
  order();
  EXPECT_THAT(openError(kSpec), HasSubstr("test-depth: cannot be opened (No such file"));
}

TEST_F(V4l2Camera, AnUnpluggedOneComesBack) {
  const auto source = openSource(kSpec, 0.0);
  ASSERT_TRUE(testing::readLive(*source));
  const LogLines log;
  color_.plugged = depth_.plugged = false;
  order();
  auto back = std::async(std::launch::async, [&] {
    for (;;) {
      auto frame = testing::readLive(*source);
      if (!frame || frame->epoch == 1) return frame;
    }
  });
  ASSERT_TRUE(waitUntil(kSoon, [&] {
    return log.text().find("was unplugged (No such device)") != std::string::npos;
  }));
  color_.plugged = depth_.plugged = true;
  order();
  const auto frame = back.get();
  ASSERT_TRUE(frame);
  expectWhole(*frame);
  EXPECT_EQ(log.count(), 2) << log.text();
  EXPECT_THAT(log.text(),
              HasSubstr("info v4l2:video-test-color,video-test-depth: frames are back"));
}

}  // namespace
}  // namespace hapticast::server
