// SPDX-License-Identifier: MIT
// Files for the tests of a single video with colour and depth.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "server/source/video/video_clip.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {

inline constexpr int kVideoFrames = 10;
inline constexpr const char* kCopyTwo =
    " -map 0 -map 1 -c:v:0 libx264 -pix_fmt:v:0 yuv420p -c:v:1 ffv1 -pix_fmt:v:1 gray16le ";

/// Frame i of a drawn depth: 500 + 100 i mm on the left, random on the right.
inline cv::Mat drawnDepth(int i, cv::Size size) {
  cv::Mat depth(size, CV_16UC1);
  cv::RNG random(static_cast<std::uint64_t>(i) + 1);
  random.fill(depth, cv::RNG::UNIFORM, 0, 65536);
  depth.colRange(0, size.width / 2).setTo(500 + 100 * i);
  return depth;
}

/// Writes video files with colour and depth, with ffmpeg. Skips the test where it is absent.
class SingleVideoFiles : public VideoFilesTest {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }
  /// Writes pictures one after the other. Returns the arguments of ffmpeg that read them.
  [[nodiscard]] std::string raw(const std::string& name, const std::string& format, cv::Size size,
                                const std::function<cv::Mat(int)>& draw, int fps = 30) const {
    std::ofstream out(folder / name, std::ios::binary);
    for (int i = 0; i < kVideoFrames; ++i) {
      const cv::Mat picture = draw(i);
      out.write(reinterpret_cast<const char*>(picture.data),
                static_cast<std::streamsize>(picture.total() * picture.elemSize()));
    }
    return "-f rawvideo -pix_fmt " + format + " -s " + std::to_string(size.width) + "x" +
           std::to_string(size.height) + " -r " + std::to_string(fps) + " -i " + name + " ";
  }
  [[nodiscard]] std::string rawDepth(cv::Size size = {64, 48}, int fps = 30) const {
    return raw(
        "depth.raw", "gray16le", size, [&](int i) { return drawnDepth(i, size); }, fps);
  }
  [[nodiscard]] static std::string rawColor() {
    return "-f lavfi -i testsrc=size=64x48:rate=30:duration=0.333 ";
  }
  [[nodiscard]] std::string openError(const std::string& name,
                                      const VideoLayout& layout = {}) const {
    return errorOf([&] { (void)openSource(at(name), 0.0, false, layout); });
  }
};

}  // namespace hapticast::server
