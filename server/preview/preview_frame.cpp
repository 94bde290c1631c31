// SPDX-License-Identifier: MIT
#include "server/preview/preview_frame.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticast::server {

namespace {

// Chosen, nominal mm: heights that vary less do not determine a range.
constexpr double kFlat_mm = 0.05;

double percentile(std::vector<float>& values, double fraction) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

// Calls `take`(position, height) for each pixel of the mask.
template <class Take>
void forEachPixel(const Relief& relief, const Take& take) {
  std::size_t at = 0;
  for (int v = 0; v < relief.rect.height; ++v) {
    for (int u = 0; u < relief.rect.width; ++u, ++at) {
      if (relief.mask[at] != 0)
        take(cv::Point(relief.rect.u + u, relief.rect.v + v), relief.height_mm[at]);
    }
  }
}

// Fits the linear relation of height and depth to all pixels by least squares.
std::optional<DepthRange> fitDepthRange(const std::vector<float>& depths,
                                        const std::vector<float>& heights_mm, double depth_mm) {
  const auto count = static_cast<double>(depths.size());
  double depth_sum = 0.0;
  double height_sum = 0.0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    depth_sum += double(depths[i]);
    height_sum += double(heights_mm[i]);
  }
  double both = 0.0;
  double heights_squared = 0.0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const double height = double(heights_mm[i]) - height_sum / count;
    both += (double(depths[i]) - depth_sum / count) * height;
    heights_squared += height * height;
  }
  if (heights_squared < kFlat_mm * kFlat_mm * count) return std::nullopt;
  const double slope = both / heights_squared;  // depth per nominal mm
  const double far = depth_sum / count - slope * height_sum / count;
  return DepthRange{far + slope * depth_mm, far};
}

}  // namespace

cv::Mat renderMask(const HapticFrame& frame, std::uint32_t id, const cv::Size& size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const HapticObject& object : frame.objects) {
    if (object.id != id || !object.relief) continue;
    forEachPixel(*object.relief,
                 [&](const cv::Point& at, float) { mask.at<unsigned char>(at) = 255; });
  }
  return mask;
}

cv::Mat renderHeights(const HapticFrame& frame, const cv::Size& size) {
  cv::Mat heights(size, CV_32FC1, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  for (const HapticObject& object : frame.objects) {
    if (!object.relief) continue;
    forEachPixel(*object.relief,
                 [&](const cv::Point& at, float height_mm) { heights.at<float>(at) = height_mm; });
  }
  return heights;
}

std::vector<std::uint32_t> listIds(const HapticFrame& frame) {
  std::vector<std::uint32_t> ids;
  ids.reserve(frame.objects.size());
  for (const HapticObject& object : frame.objects) ids.push_back(object.id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

ObjectFacts objectStats(const PreviewFrame& frame, std::uint32_t id, const Workspace& workspace) {
  ObjectFacts facts;
  facts.id = id;
  std::vector<float> depths;
  std::vector<float> heights_mm;
  double area_px = 0.0;
  for (const HapticObject& object : frame.haptic.objects) {
    if (object.id != id || !object.relief) continue;
    depths.reserve(depths.size() + object.relief->height_mm.size());
    heights_mm.reserve(depths.capacity());
    forEachPixel(*object.relief, [&](const cv::Point& at, float height_mm) {
      ++area_px;
      const float depth = frame.depth.at<float>(at);
      if (!(depth > 0.0F)) return;
      depths.push_back(depth);
      heights_mm.push_back(height_mm);
    });
  }
  facts.share = area_px / static_cast<double>(frame.color.total());
  if (depths.empty()) return facts;
  facts.mapped = fitDepthRange(depths, heights_mm, workspace.depth_mm);
  facts.near = percentile(depths, 0.02);
  facts.far = percentile(depths, 0.98);
  facts.low_mm = percentile(heights_mm, 0.02);
  facts.high_mm = percentile(heights_mm, 0.98);
  return facts;
}

std::string toText(const ObjectFacts& facts, DepthKind kind) {
  const bool metric = kind == DepthKind::kMetric;
  const char* const unit = metric ? " mm" : " of 255";
  std::string text = fmt::format("object {}: {:.1f} % of the picture, depth {:.0f} to {:.0f}{}",
                                 facts.id, 100.0 * facts.share, metric ? facts.near : facts.far,
                                 metric ? facts.far : facts.near, unit);
  if (facts.mapped) {
    const DepthRange range = *facts.mapped;
    // Depth of 8 bits has the levels 0 to 255 only.
    const double from = metric ? range.near_mm : std::clamp(range.near_mm, 0.0, 255.0);
    const double to = metric ? range.far_mm : std::clamp(range.far_mm, 0.0, 255.0);
    const auto computeHeight_mm = [&](double depth) {
      return Workspace{}.depth_mm * (depth - range.far_mm) / (range.near_mm - range.far_mm) + 0.0;
    };
    text.append(fmt::format("; {:.0f} to {:.0f}{} become {:.2g} to {:.2g} mm", from, to, unit,
                            computeHeight_mm(from), computeHeight_mm(to)));
  }
  text.append(fmt::format(", {:.1f} mm tall", facts.high_mm - facts.low_mm));
  return text;
}

}  // namespace hapticast::server
