// SPDX-License-Identifier: MIT
// OpenNI2's cameras through the real libOpenNI2 and a driver of our own (driver.cpp): formats,
// options, faults, unplugging. In real time: everything waits for conditions.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <future>
#include <map>
#include <string>
#include <thread>

#include "server/source/rgbd_source.hpp"
#include "tests/support/live_source.hpp"
#include "tests/support/openni_orders.hpp"
#include "tests/support/process.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
constexpr std::chrono::seconds kSoon{60};

class OpenniCamera : public ::testing::Test {
 protected:
  OpenniCamera() { ::setenv("HAPTICAST_OPENNI_ORDERS", orders_.file().c_str(), 1); }

  void order(const std::map<std::string, int>& orders) { orders_.order(orders); }
  [[nodiscard]] std::string calls() const { return orders_.calls(); }

 private:
  const TempFolder folder_;
  testing::OpenniOrders orders_{(folder_ / "orders").string()};
};

TEST_F(OpenniCamera, FramesAreExact) {
  const auto source = openSource("openni:", 0.0);
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.name, "openni");
  EXPECT_EQ(cv::Size(info.width_px, info.height_px), cv::Size(128, 96));
  EXPECT_EQ(info.fps, 30.0);
  EXPECT_TRUE(info.live);
  ASSERT_TRUE(info.camera);
  EXPECT_NEAR(info.camera->degreesAcross(128), 57.2958, 1e-3);  // 1 rad
  for (std::uint64_t i = 0; i < 5; ++i) {
    const auto frame = testing::readLive(*source);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->epoch, 0U);
    EXPECT_EQ(frame->depth.type(), CV_32FC1);
    EXPECT_EQ(frame->depth.at<float>(0, 0), 2000.0F);
    EXPECT_EQ(frame->depth.at<float>(48, 64), 880.0F);
    EXPECT_EQ(frame->depth.at<float>(48, 64 + 20), 893.0F);  // 880 + 20 (20/24)^2, rounded down
    // Blue, green, red; the left half of the wall is darker, so nothing is mirrored.
    EXPECT_EQ(frame->color.at<cv::Vec3b>(0, 0), cv::Vec3b(80, 70, 50));
    EXPECT_EQ(frame->color.at<cv::Vec3b>(0, 127), cv::Vec3b(80, 70, 60));
    EXPECT_EQ(frame->color.at<cv::Vec3b>(48, 64), cv::Vec3b(40, 160, 220));
  }
}

TEST_F(OpenniCamera, RegistrationAndSynchronisationAreOnAndMirroringIsOff) {
  const LogLines log;
  const auto source = openSource("openni:0", 0.0);
  EXPECT_TRUE(testing::readLive(*source));
  EXPECT_THAT(calls(), AllOf(HasSubstr("registration 1"), HasSubstr("color mirror 0"),
                             HasSubstr("depth mirror 0"), HasSubstr("sync 2")));
  EXPECT_EQ(log.text(), "");
}

TEST_F(OpenniCamera, OneWithoutRegistrationOrSynchronisationIsReadWithAWarning) {
  order({{"registration", 0}, {"sync", 0}, {"fov_mrad", 0}});
  const LogLines log;
  const auto source = openSource("openni:hapticast/test@1", 0.0);
  EXPECT_TRUE(testing::readLive(*source));
  EXPECT_FALSE(source->info().camera);
  EXPECT_EQ(log.count(), 1);
  EXPECT_THAT(log.text(), HasSubstr("warning openni:hapticast/test@1: depth is not registered"));
  EXPECT_THAT(calls(), Not(HasSubstr("registration")));
}

TEST_F(OpenniCamera, UnitsOfATenthOfAMillimetreAreRead) {
  order({{"depth_format", 101}});
  const auto frame = testing::readLive(*openSource("openni:", 0.0));
  ASSERT_TRUE(frame);
  EXPECT_FLOAT_EQ(frame->depth.at<float>(48, 64), 880.0F);
  EXPECT_FLOAT_EQ(frame->depth.at<float>(48, 84), 893.0F);
}

TEST_F(OpenniCamera, SmallerDepthIsScaled) {
  order({{"depth_width", 64}, {"depth_height", 48}});
  const LogLines log;
  const auto source = openSource("openni:", 0.0);
  const auto frame = testing::readLive(*source);
  ASSERT_TRUE(frame && testing::readLive(*source));
  EXPECT_EQ(frame->depth.size(), frame->color.size());
  EXPECT_EQ(frame->depth.at<float>(48, 64), 880.0F);
  EXPECT_EQ(frame->depth.at<float>(0, 0), 2000.0F);
  EXPECT_THAT(log.text(), HasSubstr("depth of 64 x 48 is scaled to 128 x 96"));
  EXPECT_EQ(log.count(), 1);
}

TEST_F(OpenniCamera, TheFormatsOfOneSizeNearestToVgaAreChosen) {
  order({{"more_modes", 1},
         {"color_width", 640},
         {"color_height", 480},
         {"depth_width", 320},
         {"depth_height", 240}});
  // In common they have 64x48, and 1280x1024, which is farther from 640x480.
  const auto source = openSource("openni:", 0.0);
  EXPECT_THAT(calls(), AllOf(HasSubstr("color mode 64x48"), HasSubstr("depth mode 64x48")));
}

TEST_F(OpenniCamera, AWrongStartIsOneLine) {
  order({{"plugged", 0}});
  EXPECT_EQ(openError("openni:"),
            "openni: no OpenNI2 device was found; plug one in, or check the udev rules");
  order({{"plugged", 1}});
  EXPECT_THAT(openError("openni:1"), HasSubstr("openni:1: there are only 1 OpenNI2 device(s)"));
  EXPECT_THAT(openError("openni:nowhere"), HasSubstr("openni:nowhere: cannot be opened"));
  order({{"opens", 0}});
  EXPECT_THAT(openError("openni:"),
              AllOf(HasSubstr("cannot be opened"), HasSubstr("Access to hapticast/test@1 denied")));
  order({{"opens", 1}, {"color", 0}});
  EXPECT_THAT(openError("openni:"), HasSubstr("openni: has no colour stream"));
  order({{"color", 1}, {"depth", 0}});
  EXPECT_THAT(openError("openni:"), HasSubstr("openni: has no depth stream"));
  order({{"depth", 1}, {"color_format", 203}});
  EXPECT_THAT(openError("openni:"), HasSubstr("has no RGB colour"));
  order({{"color_format", 200}, {"depth_format", 102}});
  EXPECT_THAT(openError("openni:"), HasSubstr("has no depth in mm"));
  order({{"depth_format", 100}, {"depth_height", 128}});
  EXPECT_THAT(openError("openni:"),
              HasSubstr("another shape than its colour (128x128 and 128x96)"));
  order({{"depth_height", -96}});
  EXPECT_THAT(openError("openni:"), HasSubstr("has no depth in mm of up to 1920x1080"));
}

TEST_F(OpenniCamera, OneThatDeliversNothingIsRefused) {
  order({{"depth_frames", 0}, {"sync", 0}});
  EXPECT_THAT(openError("openni:"), HasSubstr("openni: delivers no depth pictures"));
  order({{"color_frames", 0}});
  EXPECT_THAT(openError("openni:"), HasSubstr("openni: delivers no pictures"));
}

TEST_F(OpenniCamera, WrongFramesAreLeftOut) {
  const auto source = openSource("openni:", 0.0);
  ASSERT_TRUE(testing::readLive(*source));
  const LogLines log;
  for (const auto& [false_stream, value] : std::map<std::string, int>{
           {"lie_width", 1 << 30}, {"lie_bytes", 1000}, {"lie_stride", -384}}) {
    order({{false_stream, value}});
    // The frames are left out until they are whole again.
    std::thread mend([this, false_stream = false_stream] {
      EXPECT_TRUE(
          waitUntil(kSoon, [&] { return testing::countOccurrences(false_stream, calls()) >= 5; }));
      order({{false_stream, 0}});
    });
    for (int i = 0; i < 3; ++i) {
      const auto frame = testing::readLive(*source);
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->depth.at<float>(48, 64), 880.0F) << false_stream;
    }
    mend.join();
  }
  EXPECT_THAT(log.text(), HasSubstr("the picture is left out (time 1)"));
}

TEST_F(OpenniCamera, AnUnpluggedOneComesBack) {
  const auto source = openSource("openni:", 0.0);
  ASSERT_TRUE(testing::readLive(*source));
  const LogLines log;
  order({{"plugged", 0}});
  auto back = std::async(std::launch::async, [&] {
    for (;;) {
      auto frame = testing::readLive(*source);
      if (!frame || frame->epoch == 1) return frame;
    }
  });
  ASSERT_TRUE(
      waitUntil(kSoon, [&] { return log.text().find("was unplugged") != std::string::npos; }));
  EXPECT_EQ(back.wait_for(std::chrono::milliseconds(1500)), std::future_status::timeout);
  order({{"plugged", 1}});
  ASSERT_EQ(back.wait_for(kSoon), std::future_status::ready);
  const auto frame = back.get();
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->clip_time_s, 0.1);
  EXPECT_EQ(frame->depth.at<float>(48, 64), 880.0F);
  EXPECT_THAT(log.text(),
              AllOf(StartsWith("warning openni: was unplugged; the server tries to open it again "
                               "each second\ninfo openni: frames are back after "),
                    EndsWith(" s\n")));
}

TEST_F(OpenniCamera, ASilentOneIsOpenedAgain) {
  const auto source = openSource("openni:", 0.0);
  ASSERT_TRUE(testing::readLive(*source));
  const LogLines log;
  order({{"color_frames", 0}, {"depth_frames", 0}});
  auto back = std::async(std::launch::async, [&] {
    for (;;) {
      const auto frame = testing::readLive(*source);
      if (!frame || frame->epoch == 1) return frame.has_value();
    }
  });
  ASSERT_TRUE(waitUntil(
      kSoon, [&] { return log.text().find("delivers no pictures") != std::string::npos; }));
  order({{"color_frames", 1}, {"depth_frames", 1}});
  EXPECT_TRUE(back.get());
  EXPECT_EQ(log.count(), 2) << log.text();
}

TEST_F(OpenniCamera, AReadWaitsOnlyAMomentForAnUnpluggedOne) {
  const auto source = openSource("openni:", 0.0);
  ASSERT_TRUE(testing::readLive(*source));
  const LogLines log;
  order({{"plugged", 0}});
  ASSERT_TRUE(waitUntil(kSoon, [&] {
    (void)source->read();
    return log.text().find("was unplugged") != std::string::npos;
  }));
  EXPECT_FALSE(source->read());
}

}  // namespace
}  // namespace hapticast::server
