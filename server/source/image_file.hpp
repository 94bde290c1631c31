// SPDX-License-Identifier: MIT
// Image files and raw depth pictures from outside: checks limits before decoding. A problem is a
// phrase that follows the file's name in a message. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

// JPEG header parser: reads the size of a picture before a decoder allocates memory for it. Thread:
// any.

/// Size of a picture.
struct PictureSize {
  std::uint32_t width_px = 0;
  std::uint32_t height_px = 0;
  bool operator==(const PictureSize&) const = default;
};

/// Returns the size in the frame header (ITU T.81 annex B) without decoding; nullopt if there is
/// none.
[[nodiscard]] std::optional<PictureSize> jpegSize(std::span<const std::uint8_t> jpeg);

/// An image, or its problem ("is 4000x3000, larger than 1920x1080").
struct ImageResult {
  cv::Mat image;
  std::string problem;

  [[nodiscard]] bool ok() const { return problem.empty(); }
};

/// Meaning of the values of a depth picture.
struct DepthFormat {
  DepthKind kind = DepthKind::kMetric;
  double mm_per_unit = 1.0;  ///< kMetric only
};

/// Formats a size, for example "640x480".
[[nodiscard]] std::string sizeText(int width_px, int height_px);

/// Returns whether a source may have this size (1x1 .. kMaxWidth_px x kMaxHeight_px of
/// common/haptic_frame.hpp).
[[nodiscard]] bool sizeAllowed(int width_px, int height_px);

/// Reads a PNG or JPEG of at most 1920x1080 px and 64 MiB: as BGR (CV_8UC3), or in the format of
/// the file.
[[nodiscard]] ImageResult readColorFile(const std::filesystem::path& file);
[[nodiscard]] ImageResult readRawFile(const std::filesystem::path& file);

/// Decodes the bytes of such a file. `flags`: cv::ImreadModes.
[[nodiscard]] ImageResult decodeImage(std::span<const std::uint8_t> bytes, int flags);

/// Converts a depth picture (CV_8UC1, CV_8UC3 with equal channels, or CV_16UC1) to CV_32FC1 for
/// RgbdFrame.
[[nodiscard]] ImageResult toDepth(const cv::Mat& raw, const DepthFormat& format);

/// Converts an object mask (CV_8UC1) to 0 outside, n for object n. Values above kMaxObjects mean a
/// black and white picture: then object 1 covers the pixels of at least half brightness.
[[nodiscard]] ImageResult toMask(const cv::Mat& raw);

/// Returns whether a three-channel picture shows depth by a colour map, which cannot be converted
/// back to depth.
[[nodiscard]] bool isColorCoded(const cv::Mat& raw);

}  // namespace hapticast::server
