// SPDX-License-Identifier: MIT
#include "server/pipeline/clip_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scenes/ball_scene.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using test::BallScene;
using test::FunctionSource;

constexpr std::uint64_t kFrames = 10;

class ClipScanLook : public testing::Test {
 protected:
  bool look(const VisionSettings& settings = {}) {
    Vision vision(source.info(), settings);
    return scanClip(vision, source, media, [this](double share) {
      shares.push_back(share);
      return shares.size() != stop_after;
    });
  }

  BallScene scene{.width = 160, .height = 120, .radius_px = 20};
  ManualClock clock;
  LocalMediaClock media{clock};
  std::uint64_t read = 0;
  FunctionSource source{scene.info(), kFrames, [this](std::uint64_t i) {
                          ++read;
                          clock.advance(std::chrono::milliseconds(600));
                          return scene.frame(i, 80 + double(i), 60);
                        }};
  std::size_t stop_after = 0;
  std::vector<double> shares;
};

TEST_F(ClipScanLook, ReportsHowFarItIsEveryTwoSecondsAndReportsEachFrame) {
  const LogLines log;
  EXPECT_TRUE(look());
  ASSERT_EQ(shares.size(), kFrames);
  for (std::size_t i = 0; i < kFrames; ++i) EXPECT_DOUBLE_EQ(shares[i], 0.1 * double(i + 1));
  EXPECT_EQ(log.text(), "info scanning the clip: 40 %\ninfo scanning the clip: 80 %\n");
}

TEST_F(ClipScanLook, EndsAtTheFrameInWhichItIsStopped) {
  stop_after = 3;
  EXPECT_FALSE(look());
  EXPECT_EQ(read, 3U);
}

TEST_F(ClipScanLook, IsLeftOutWhereNothingIsToBeFound) {
  VisionSettings settings;
  settings.motion = MotionMode::kNone;
  EXPECT_TRUE(look(settings));
  EXPECT_EQ(read, kFrames) << "for the range";
  read = 0;
  settings.depth_range = DepthRange{600, 900};
  EXPECT_TRUE(look(settings));
  EXPECT_EQ(read, 0U);
  settings.motion = MotionMode::kAuto;
  settings.plan.forced[static_cast<std::size_t>(Stage::kMotion)] = false;
  EXPECT_TRUE(look(settings));
  EXPECT_EQ(read, 0U);
  settings.plan = {};
  EXPECT_TRUE(look(settings));
  EXPECT_EQ(read, kFrames) << "for the motion";
}

}  // namespace
}  // namespace hapticast::server
