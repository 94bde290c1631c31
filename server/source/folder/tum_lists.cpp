// SPDX-License-Identifier: MIT
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>

#include "common/text.hpp"
#include "server/source/folder/text_file.hpp"
#include "server/source/folder/timed_images.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

constexpr double kTolerance_s = 0.020;
// Horizontal field of view of TUM's recordings: the recommended focal length of 525 px at 640 px.
constexpr double kKinect_deg = 62.7;

/// Returns the image of one line; nullopt if the line is a comment or empty. Throws SourceError.
std::optional<TimedImage> parseLine(std::string_view line, const fs::path& list,
                                    std::size_t line_number) {
  while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) {
    line.remove_suffix(1);
  }
  if (line.empty() || line.front() == '#') return std::nullopt;
  const std::size_t space = line.find_first_of(" \t");
  const auto time = parseNumber(line.substr(0, space));
  if (!time || space == std::string_view::npos) {
    throw SourceError(list.string() + ": line " + std::to_string(line_number) +
                      " is not \"timestamp file\"; correct or remove it");
  }
  line.remove_prefix(line.find_first_not_of(" \t", space));
  return TimedImage{*time, list.parent_path() / line};
}

/// Returns the images of a list, in order of time.
std::vector<TimedImage> readTumList(const fs::path& list) {
  std::vector<TimedImage> images;
  const std::string text = readText(list);
  std::size_t line_number = 0;
  bool runs_back = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const auto image = parseLine(std::string_view(text.data() + at, end - at), list, ++line_number);
    at = end + 1;
    if (!image) continue;
    if (!runs_back && !images.empty() && image->time < images.back().time) {
      runs_back = true;
      spdlog::warn(
          "--source {}: line {} has an earlier time than the line before; the server uses the "
          "images in the order of their times",
          list.string(), line_number);
    }
    images.push_back(*image);
  }
  if (images.empty()) throw SourceError(list.string() + ": lists no frames");
  std::stable_sort(images.begin(), images.end(),
                   [](const TimedImage& a, const TimedImage& b) { return a.time < b.time; });
  return images;
}

/// Returns whether so many images share a time that the times must have been rounded. A few images
/// may be listed twice.
bool isRounded(const std::vector<TimedImage>& images) {
  std::size_t shared = 0;
  for (std::size_t i = 1; i < images.size(); ++i)
    shared += images[i].time == images[i - 1].time ? 1 : 0;
  return 10 * shared > images.size();
}

/// Pairs images by the order of the lines, because their times were rounded. Throws SourceError if
/// the times of a pair differ or a list is longer.
std::vector<std::optional<std::size_t>> pairRounded(const std::vector<TimedImage>& colors,
                                                    const std::vector<TimedImage>& depths,
                                                    const fs::path& list) {
  std::vector<std::optional<std::size_t>> pairs;
  bool alike = colors.size() == depths.size();
  for (std::size_t i = 0; alike && i < colors.size(); ++i) {
    alike = std::abs(colors[i].time - depths[i].time) <= kTolerance_s;
    pairs.emplace_back(i);
  }
  if (!alike) {
    throw SourceError(list.string() +
                      ": many lines share one time, so times were rounded and cannot pair images; "
                      "write them with six decimals (%.6f)");
  }
  spdlog::warn(
      "--source {}: many lines share one time; the server pairs the lines of rgb.txt and depth.txt "
      "by their order, so write times with six decimals (%.6f)",
      list.string());
  return pairs;
}

}  // namespace

ClipFiles findTum(const fs::path& folder) {
  const auto colors = readTumList(folder / "rgb.txt");
  const auto depths = readTumList(folder / "depth.txt");
  const bool rounded = isRounded(colors) || isRounded(depths);
  const auto pairs =
      rounded ? pairRounded(colors, depths, folder / (isRounded(colors) ? "rgb.txt" : "depth.txt"))
              : pairNearest(colors, depths, kTolerance_s);
  ClipFiles clip;
  std::vector<TimedImage> paired;
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (!pairs[i]) continue;
    clip.frames.push_back({colors[i].file, depths[*pairs[i]].file, {}, {}, {}});
    paired.push_back(colors[i]);
  }
  if (paired.empty()) {
    throw SourceError(folder.string() +
                      ": no timestamp in depth.txt is within 20 ms of one in "
                      "rgb.txt; both need the same clock");
  }
  clip.fps = rateOfStep(medianStep(paired));
  clip.declared_depth_bits = 16;
  clip.mm_per_unit = 0.2;
  clip.fov_deg = kKinect_deg;
  return clip;
}

}  // namespace hapticast::server
