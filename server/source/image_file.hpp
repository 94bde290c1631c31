// SPDX-License-Identifier: MIT
// Image files and raw depth pictures from outside: limits before anything is decoded, problems as
// phrases that complete a sentence beginning with the file's name. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// An image, or what is wrong ("is 4000x3000, larger than 1920x1080").
struct ImageResult {
  cv::Mat image;
  std::string problem;

  [[nodiscard]] bool ok() const { return problem.empty(); }
};

/// How the values of a depth picture are to be read.
struct DepthFormat {
  DepthKind kind = DepthKind::kMetric;
  double mm_per_unit = 1.0;  ///< kMetric only
};

/// "640x480".
[[nodiscard]] std::string sizeText(int width_px, int height_px);

/// Whether a source may have this size (1x1 .. kMaxWidth_px x kMaxHeight_px of
/// common/haptic_frame).
[[nodiscard]] bool sizeAllowed(int width_px, int height_px);

/// Reads a PNG or JPEG of at most 1920x1080 and 64 MiB: as BGR (CV_8UC3), or as it is in the file.
[[nodiscard]] ImageResult readColorFile(const std::filesystem::path& file);
[[nodiscard]] ImageResult readRawFile(const std::filesystem::path& file);

/// The same of a file's bytes; `flags` are cv::ImreadModes.
[[nodiscard]] ImageResult decodeImage(std::span<const std::uint8_t> bytes, int flags);

/// A depth picture as it came (CV_8UC1, CV_8UC3 with equal channels, CV_16UC1) -> CV_32FC1 as
/// RgbdFrame has it.
[[nodiscard]] ImageResult toDepth(const cv::Mat& raw, const DepthFormat& format);

/// An object mask as it came (CV_8UC1) -> 0 outside, n for object n. Values that are no object
/// numbers (above kMaxObjects) mean a picture in black and white: object 1 where it is at least
/// half bright.
[[nodiscard]] ImageResult toMask(const cv::Mat& raw);

/// Whether a three-channel picture shows depth as colours (not grey), which nobody can turn back
/// into depth.
[[nodiscard]] bool isColorCoded(const cv::Mat& raw);

}  // namespace hapticast::server
