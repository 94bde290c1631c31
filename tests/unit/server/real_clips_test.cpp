// SPDX-License-Identifier: MIT
// The real clips as a source. They are skipped with a line where they are absent.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

namespace fs = std::filesystem;

struct RealClip {
  const char* name;
  std::uint64_t frames;
  int width_px, height_px;
  double fps;
  double valid;
};

class ImageSequenceOfRealClip : public testing::TestWithParam<RealClip> {};

INSTANTIATE_TEST_SUITE_P(ImageSequence, ImageSequenceOfRealClip,
                         testing::Values(RealClip{"visp_rbt_desk", 99, 640, 480, 30.0, 0.91},
                                         RealClip{"dkvfx_typing_person", 48, 512, 424, 24.0, 0.32},
                                         RealClip{"tum_fr1_rpy", 150, 320, 240, 30.0, 0.79}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(ImageSequenceOfRealClip, ReadsAllOfIt) {
  const RealClip& clip = GetParam();
  const fs::path folder = fs::path(HAPTICAST_CLIPS) / clip.name;
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not here";
  const LogLines log;
  ImageSequence source(folder.string(), 0.0);
  EXPECT_EQ(source.info().width_px, clip.width_px);
  EXPECT_EQ(source.info().height_px, clip.height_px);
  EXPECT_EQ(source.info().fps, clip.fps);
  EXPECT_EQ(source.info().depth_kind, DepthKind::kMetric);
  EXPECT_TRUE(source.info().camera);
  std::uint64_t frames = 0;
  double valid = 0.0;
  while (const auto frame = source.read()) {
    EXPECT_EQ(frame->index, frames);
    ++frames;
    valid += static_cast<double>(cv::countNonZero(frame->depth)) /
             static_cast<double>(frame->depth.total());
  }
  EXPECT_EQ(frames, clip.frames);
  EXPECT_EQ(source.info().frame_count, clip.frames);
  EXPECT_NEAR(valid / static_cast<double>(frames), clip.valid, 0.01);
  EXPECT_EQ(log.count(), 0) << log.text();
}

}  // namespace
}  // namespace hapticast::server
