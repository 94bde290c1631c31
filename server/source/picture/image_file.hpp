// SPDX-License-Identifier: MIT
// Reads image files and depth pictures from outside. It checks limits before it decodes. Functions
// describe a problem by a phrase that follows the file's name in a message. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>

#include "server/source/picture/image_result.hpp"
#include "server/source/picture/picture_header.hpp"
#include "server/source/picture/picture_size.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Meaning of the values of a depth picture.
struct DepthFormat {
  DepthKind kind = DepthKind::kMetric;
  double mm_per_unit = 1.0;  ///< mm for each unit; only with kMetric
};

/// Sets the unit of `format` to that of --depth-unit, if there is one. Throws SourceError that
/// names `file` if its depth has 8 bits, which are heights without a unit.
void setDepthUnit(DepthFormat& format, const std::optional<double>& mm_per_unit,
                  const std::string& file);

/// Return the image of a file of at most 64 MiB and a size that is readable, or the problem of the
/// file. The formats are those of picture_header.hpp, and PFM, NPY and NPZ with one matrix.
/// readColorFile() converts the image to BGR (CV_8UC3). It refuses PFM, NPY and NPZ. readRawFile()
/// does not convert the image, but floats have 32 bits.
[[nodiscard]] ImageResult readColorFile(const std::filesystem::path& file);
[[nodiscard]] ImageResult readRawFile(const std::filesystem::path& file);

/// Decodes `bytes`, the content of such a file. Returns the image, or the problem of the
/// file. `flags`: cv::ImreadModes.
[[nodiscard]] ImageResult decodeImage(std::span<const std::uint8_t> bytes, int flags);

/// Returns the depth picture `raw`, converted to the values of RgbdFrame::depth (CV_32FC1), or its
/// problem. `raw`: CV_8UC1, CV_8UC3 with equal channels, CV_16UC1, or CV_32FC1. A float that is not
/// positive, not a number or beyond 10 km becomes 0, as a missing depth.
[[nodiscard]] ImageResult toDepth(const cv::Mat& raw, const DepthFormat& format);

/// Returns the mask picture `raw` (CV_8UC1) with 0 outside the objects and n for object n, or its
/// problem. If a value of `raw` is above kMaxObjects, `raw` counts as black and white. Object 1
/// then covers its pixels of at least half brightness.
[[nodiscard]] ImageResult toMask(const cv::Mat& raw);

/// Returns whether `raw`, a picture with three channels, shows depth in false colours. Such colours
/// cannot be converted back to depth.
[[nodiscard]] bool isColorCoded(const cv::Mat& raw);

}  // namespace hapticast::server
