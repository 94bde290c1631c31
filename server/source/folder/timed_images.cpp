// SPDX-License-Identifier: MIT
#include "server/source/folder/timed_images.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "common/text.hpp"

namespace hapticast::server {

namespace fs = std::filesystem;

namespace {

/// A number in the name of an image.
struct Stamp {
  double value = 0.0;
  bool is_seconds = false;  // else the unit is that of all images
};

std::optional<Stamp> parseStamp(const fs::path& image) {
  constexpr std::size_t kLeastDigits = 10;
  constexpr std::size_t kMostDigits = 19;
  const std::string name = image.stem().string();
  const std::size_t before = name.find_last_not_of("0123456789.");
  const std::string text = name.substr(before == std::string::npos ? 0 : before + 1);
  const std::size_t dot = text.find('.');
  const bool is_seconds = dot != std::string::npos;
  const bool fits = is_seconds ? dot > 0 && dot + 1 < text.size() && text.size() <= 32
                               : text.size() >= kLeastDigits && text.size() <= kMostDigits;
  const auto value = fits ? parseNumber(text) : std::nullopt;
  if (!value) return std::nullopt;
  return Stamp{*value, is_seconds};
}

void sortByTime(std::vector<TimedImage>& images) {
  std::stable_sort(images.begin(), images.end(),
                   [](const TimedImage& a, const TimedImage& b) { return a.time < b.time; });
}

/// Returns the images with the numbers in their names, in their order; nullopt if a name is no time
/// stamp, or one of another kind than `is_seconds`.
std::optional<std::vector<TimedImage>> readStamps(const std::vector<fs::path>& images,
                                                  bool is_seconds) {
  std::vector<TimedImage> out;
  for (const fs::path& image : images) {
    const auto stamp = parseStamp(image);
    if (!stamp || stamp->is_seconds != is_seconds) return std::nullopt;
    out.push_back({stamp->value, image});
  }
  return out;
}

/// Returns the length of the unit of stamps with this step between images, s: that with a plausible
/// rate, because names do not state it. Numbers without such a unit count images of 25 frames/s.
double guessUnit_s(double step) {
  for (const double unit_s : {1e-9, 1e-6, 1e-3}) {
    const double fps = 1.0 / (step * unit_s);
    if (fps >= 1.0 && fps <= 240.0) return unit_s;
  }
  return step > 0.0 ? 0.04 / step : 1.0;
}

bool isSorted(const std::vector<TimedImage>& images) {
  return std::is_sorted(images.begin(), images.end(),
                        [](const TimedImage& a, const TimedImage& b) { return a.time < b.time; });
}

/// Returns whether images of the same place belong together: both are in order of time, and their
/// distances in time are the same. A constant distance is that of two clocks.
bool areInStep(const std::vector<TimedImage>& colors, const std::vector<TimedImage>& depths,
               double tolerance) {
  if (colors.size() != depths.size() || !isSorted(colors) || !isSorted(depths)) return false;
  std::vector<double> distances;
  for (std::size_t i = 0; i < colors.size(); ++i)
    distances.push_back(depths[i].time - colors[i].time);
  const auto [least, most] = std::minmax_element(distances.begin(), distances.end());
  return *most - *least <= tolerance;
}

}  // namespace

std::vector<std::optional<std::size_t>> pairNearest(const std::vector<TimedImage>& colors,
                                                    const std::vector<TimedImage>& depths,
                                                    double tolerance) {
  const auto earlier = [](const TimedImage& image, double time) { return image.time < time; };
  std::vector<std::optional<std::size_t>> pairs(colors.size());
  std::map<std::size_t, std::size_t> color_of;  // for each depth
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const double time = colors[i].time;
    const auto after = std::lower_bound(depths.begin(), depths.end(), time, earlier);
    auto j = static_cast<std::size_t>(after - depths.begin());
    const auto distance = [&](std::size_t depth, std::size_t color) {
      return std::abs(depths[depth].time - colors[color].time);
    };
    if (j == depths.size() || (j > 0 && distance(j - 1, i) <= distance(j, i))) --j;
    if (distance(j, i) > tolerance) continue;
    const auto [taken, is_new] = color_of.try_emplace(j, i);
    if (!is_new && distance(j, i) >= distance(j, taken->second)) continue;
    if (!is_new) pairs[taken->second].reset();
    taken->second = i;
    pairs[i] = j;
  }
  return pairs;
}

double medianStep(const std::vector<TimedImage>& images) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < images.size(); ++i)
    steps.push_back(images[i].time - images[i - 1].time);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

double rateOfStep(double step_s) {
  const double fps = 1.0 / step_s;
  return fps >= 1.0 && fps <= 240.0 ? fps : 25.0;
}

bool pairByStamps(const std::vector<fs::path>& color_files,
                  const std::vector<fs::path>& depth_files, ClipFiles& clip) {
  const auto first = parseStamp(color_files.front());
  if (!first) return false;
  auto colors = readStamps(color_files, first->is_seconds);
  auto depths = readStamps(depth_files, first->is_seconds);
  if (!colors || !depths) return false;
  const auto named_colors = *colors;
  const auto named_depths = *depths;
  sortByTime(*colors);
  sortByTime(*depths);
  const double step = medianStep(*colors);
  const double depth_step = medianStep(*depths);
  const double tolerance = 0.5 * (depth_step > 0.0 ? std::min(step, depth_step) : step);
  if (areInStep(named_colors, named_depths, tolerance)) return false;
  const auto pairs = pairNearest(*colors, *depths, tolerance);
  std::size_t count = 0;
  for (const auto& pair : pairs) count += pair ? 1 : 0;
  if (count == 0) return false;
  clip.fps = rateOfStep(step * (first->is_seconds ? 1.0 : guessUnit_s(step)));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    FrameFiles& frame = clip.frames.emplace_back();
    frame.color = (*colors)[i].file;
    if (pairs[i]) frame.depth = (*depths)[*pairs[i]].file;
  }
  if (count < colors->size() || count < depths->size()) {
    spdlog::warn(
        "--source {}: belongs to its depth by the times in the names; {} colour images have no "
        "depth, and {} depth images no colour",
        color_files.front().parent_path().string(), colors->size() - count, depths->size() - count);
  }
  return true;
}

}  // namespace hapticast::server
