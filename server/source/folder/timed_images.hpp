// SPDX-License-Identifier: MIT
// Pairs colour and depth images by their times. The times are in lists (TUM RGB-D) or in the names
// of the images. Thread: any.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include "server/source/folder/frame_files.hpp"

namespace hapticast::server {

/// An image file and its time, in the unit of its folder.
struct TimedImage {
  double time = 0.0;
  std::filesystem::path file;
};

/// Returns for each colour image the index of the depth image that is nearest in time and at most
/// `tolerance` away. No depth image has two colour images: the nearer one has it. Requires both
/// to be sorted by time.
[[nodiscard]] std::vector<std::optional<std::size_t>> pairNearest(
    const std::vector<TimedImage>& colors, const std::vector<TimedImage>& depths, double tolerance);

/// Returns the median of the steps between images that are sorted by time. 0: fewer than two.
[[nodiscard]] double medianStep(const std::vector<TimedImage>& images);

/// Returns the rate of images with this step, frames/s. A step without a rate of 1 to 240 frames/s
/// has 25.
[[nodiscard]] double rateOfStep(double step_s);

/// Returns the clip of a folder of TUM RGB-D: the lists rgb.txt and depth.txt. Its frames are in
/// order of time. Logs one warning for each list whose times run back. Throws SourceError. If many
/// lines share one time, the times were rounded. Images then belong together by the order of the
/// lines, with a warning, if both lists have the same times line by line; otherwise it throws.
[[nodiscard]] ClipFiles findTum(const std::filesystem::path& folder);

/// Sets the frames of `clip` if the names of all images are time stamps: seconds with a dot, or 10
/// to 19 digits. It does so if the numbers of images differ, or if the order of the stamps shows
/// that images are missing. Each colour image then has the depth image that is nearest in time, at
/// most half a median step away, and no depth image is used twice. A colour image without depth is
/// a gap. A warning says how many images have no partner. Sets the rate of the clip too. Returns
/// whether it set the frames.
bool pairByStamps(const std::vector<std::filesystem::path>& colors,
                  const std::vector<std::filesystem::path>& depths, ClipFiles& clip);

}  // namespace hapticast::server
