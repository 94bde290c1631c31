// SPDX-License-Identifier: MIT
#include "server/vision/surface/enhance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr int kRim_px = 5;
constexpr int kSweeps = 60;
constexpr double kSmooth_mm = 0.65;
constexpr std::array kWider_mm{1.0, 1.6, 2.6};
constexpr double kFinest_px_mm = 12.0;  // smoothed over no more pixels in finer pictures
constexpr double kThesisSigma_px = 2.0;
constexpr double kMixed = 0.1;  // of the pixels at an edge

cv::Mat pushPull(const cv::Mat& weighted, const cv::Mat& weight) {
  cv::Mat mean;
  cv::divide(weighted, cv::max(weight, 1e-6), mean);
  if (weighted.cols <= 2 && weighted.rows <= 2) {
    const double total = cv::sum(weight)[0];
    mean.setTo(total > 0 ? cv::sum(weighted)[0] / total : 0.0, weight <= 1e-6);
    return mean;
  }
  cv::Mat half_weighted;
  cv::Mat half_weight;
  const cv::Size half((weighted.cols + 1) / 2, (weighted.rows + 1) / 2);
  cv::resize(weighted, half_weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, half_weight, half, 0, 0, cv::INTER_AREA);
  cv::Mat coarse;
  cv::resize(pushPull(half_weighted, half_weight), coarse, weighted.size(), 0, 0, cv::INTER_LINEAR);
  coarse.copyTo(mean, weight <= 1e-6);
  return mean;
}

void sweep(cv::Mat& values, const cv::Mat& inside, const std::vector<cv::Point>& holes) {
  const cv::Rect whole({0, 0}, values.size());
  const cv::Point steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (int round = 0; round < kSweeps; ++round) {
    for (const cv::Point& at : holes) {
      float sum = 0;
      int count = 0;
      for (const cv::Point& step : steps) {
        if (!whole.contains(at + step) || inside.at<unsigned char>(at + step) == 0) continue;
        sum += values.at<float>(at + step);
        ++count;
      }
      if (count > 0) values.at<float>(at) = sum / static_cast<float>(count);
    }
  }
}

// Fewer than `wanted` of the eight neighbours are known and hang together with this pixel.
bool lonely(const cv::Mat& depth, const cv::Mat& known, int u, int v, double sigma, int wanted) {
  const float z = depth.at<float>(v, u);
  const auto step = static_cast<float>(8 + 5 * sigma);
  int near = 0;
  for (int j = std::max(0, v - 1); j <= std::min(depth.rows - 1, v + 1); ++j) {
    const auto* row = depth.ptr<float>(j);
    const auto* is_known = known.ptr<unsigned char>(j);
    for (int i = std::max(0, u - 1); i <= std::min(depth.cols - 1, u + 1); ++i) {
      if ((i == u && j == v) || is_known[i] == 0 || std::abs(row[i] - z) > step) continue;
      if (++near >= wanted) return false;
    }
  }
  return true;
}

// The depths around a pixel of the rim: the object's core and what is behind it, carried on to it.
struct Sides {
  cv::Mat object;  // CV_32FC1 at half size; both empty where one of them is not known
  cv::Mat behind;
  bool sharp = false;  // clean depth that jumps from one to the other

  [[nodiscard]] double objectAt(int u, int v) const {
    return double(object.at<float>(v / 2, u / 2));
  }
  [[nodiscard]] double behindAt(int u, int v) const {
    return double(behind.at<float>(v / 2, u / 2));
  }
};

bool background(double z, double object, double behind, double sigma, bool sharp) {
  const double gap = behind - object;
  if (std::abs(gap) <= 15 + 6 * sigma) return false;  // contact: nothing to tell them apart by
  const double off = z - object;
  const double near_behind = std::abs(z - behind);
  // A steep rim, as of a ball, goes far off the core; where no pixel is mixed it is all the
  // object's.
  if (sharp) return near_behind < std::min(std::abs(off), 3 + 4 * sigma);
  const bool same_side = off * gap > 0;
  if (same_side) return near_behind < std::abs(off) && std::abs(off) > 12 + 4 * sigma;
  return std::abs(off) > 60 + 6 * sigma;
}

// `values` where `known`, halved, and filled everywhere: enough where they are only compared with.
cv::Mat filledAtHalfSize(const cv::Mat& values, const cv::Mat& known) {
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat weighted = values.mul(weight);
  const cv::Size half((values.cols + 1) / 2, (values.rows + 1) / 2);
  cv::resize(weighted, weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, weight, half, 0, 0, cv::INTER_AREA);
  return pushPull(weighted, weight);
}

// Whether hardly a pixel just outside the mask lies between object and background.
bool sharpEdges(const cv::Mat& depth, const cv::Mat& mask, const Sides& sides, double sigma) {
  const cv::Mat ring = dilatedBy(mask, 3) & (mask == 0) & (depth > 0);
  const double tolerance = 12 + 4 * sigma;
  int between = 0;
  int all = 0;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (ring.at<uchar>(v, u) == 0) continue;
      const auto z = double(depth.at<float>(v, u));
      between += std::abs(z - sides.behindAt(u, v)) > tolerance &&
                         std::abs(z - sides.objectAt(u, v)) > tolerance
                     ? 1
                     : 0;
      ++all;
    }
  }
  return between < kMixed * all;
}

Sides sidesOf(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& core_known,
              const DepthNoise& noise) {
  const cv::Mat around = (dilatedBy(mask, kRim_px) == 0) & (depth > 0);
  if (cv::countNonZero(core_known) < 20 || cv::countNonZero(around) < 20) return {};
  Sides out{filledAtHalfSize(depth, core_known), filledAtHalfSize(depth, around)};
  const double depth_mm = cv::mean(depth, core_known)[0];
  const double sigma = noise.at(depth_mm);
  out.sharp = noise.clean(depth_mm) && sharpEdges(depth, mask, out, sigma);
  return out;
}

// Of the pixels `known` (measured, inside `mask`): those that are the object's.
cv::Mat gated(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
              const DepthNoise& noise) {
  const cv::Mat core = erodedBy(mask, kRim_px);
  const Sides sides = sidesOf(depth, mask, core & known, noise);
  cv::Mat keep = known.clone();
  for (int v = 0; v < depth.rows; ++v) {
    const auto* is_known = known.ptr<unsigned char>(v);
    const auto* is_core = core.ptr<unsigned char>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (is_known[u] == 0) continue;
      const auto z = double(depth.at<float>(v, u));
      const double sigma = noise.at(z);
      const bool rim = is_core[u] == 0;
      const bool drop =
          (rim && !sides.object.empty() &&
           background(z, sides.objectAt(u, v), sides.behindAt(u, v), sigma, sides.sharp)) ||
          (!(rim && sides.sharp) && lonely(depth, known, u, v, sigma, rim ? 2 : 3));
      if (drop) keep.at<unsigned char>(v, u) = 0;
    }
  }
  return keep;
}

// Depth that is only rounded: the truth is within half a step of it. What a fit makes of a rim that
// bends too much for it is cut to that.
void smoothTerraces(cv::Mat& height, const cv::Mat& rounded, const Surface& surface, double half_mm,
                    double px_per_mm) {
  for (const double sigma_mm : kWider_mm)
    widenFit(height, rounded, surface.mask, surface.measured, half_mm, sigma_mm * px_per_mm);
  cv::Mat kept;
  cv::max(height, rounded - half_mm, kept);
  cv::min(kept, rounded + half_mm, kept);
  kept.copyTo(height, surface.measured);
}

}  // namespace

cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted) {
  std::vector<cv::Point> holes;
  cv::findNonZero(wanted & (known == 0), holes);
  if (holes.empty() || cv::countNonZero(known) == 0) return values.clone();
  cv::Mat out;
  cv::resize(filledAtHalfSize(values, known), out, values.size(), 0, 0, cv::INTER_LINEAR);
  values.copyTo(out, known);
  sweep(out, wanted | known, holes);
  return out;
}

Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise) {
  const cv::Rect box = boxAround(mask, 0);
  const cv::Mat known = mask(box) & (depth(box) > 0);
  const bool rounded = noise.eight_bit && noise.clean(cv::mean(depth(box), known)[0]);
  return {box, mask(box).clone(), depth(box).clone(), known, rounded ? noise.quantum_mm : 0.0};
}

Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method) {
  Surface out = rawSurface(depth, mask, noise);
  if (method == Method::kThesis) {
    out.quantum_mm = 0.0;
    return out;
  }
  const cv::Rect wide = boxAround(mask, 3 * kRim_px);
  const cv::Rect inner(out.box.tl() - wide.tl(), out.box.size());
  const cv::Mat object = mask(wide);
  const cv::Mat near_depth = depth(wide);
  const cv::Mat measured = gated(near_depth, object, object & (near_depth > 0), noise);
  out.depth = filled(near_depth, measured, object)(inner).clone();
  out.measured = measured(inner).clone();
  return out;
}

std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method, bool smooth) {
  const double gain = workspace.depth_mm / (range.far_mm - range.near_mm);
  cv::Mat height;
  surface.depth.convertTo(height, CV_32F, -gain, gain * range.far_mm);
  const auto top = static_cast<float>(workspace.depth_mm);
  if (method == Method::kThesis) {
    height.setTo(0, (surface.mask == 0) | (surface.depth <= 0));
    height = cv::max(cv::min(height, workspace.depth_mm), 0.0);
    const int margin = 8;  // the zero outside is part of what is smoothed
    cv::copyMakeBorder(height, height, margin, margin, margin, margin, cv::BORDER_CONSTANT,
                       cv::Scalar(0));
    cv::GaussianBlur(height, height, {}, kThesisSigma_px);
    height = height(cv::Rect({margin, margin}, surface.box.size()));
  } else {
    height.setTo(0, surface.depth <= 0);
    const double px_per_mm = std::min(kFinest_px_mm, 1.0 / workspace.mmPerPixel().maxCoeff());
    const cv::Mat rounded = height;
    if (smooth) height = quadraticFit(height, surface.mask, std::max(0.8, kSmooth_mm * px_per_mm));
    if (smooth && surface.quantum_mm > 0)
      smoothTerraces(height, rounded, surface, 0.5 * gain * surface.quantum_mm, px_per_mm);
  }
  auto relief = std::make_shared<Relief>();
  relief->rect = {surface.box.x, surface.box.y, surface.box.width, surface.box.height};
  relief->height_mm.resize(surface.mask.total());
  relief->mask.resize(surface.mask.total());
  std::size_t at = 0;
  for (int v = 0; v < height.rows; ++v) {
    const auto* inside = surface.mask.ptr<unsigned char>(v);
    const auto* h = height.ptr<float>(v);
    for (int u = 0; u < height.cols; ++u, ++at) {
      if (inside[u] == 0) continue;
      relief->mask[at] = 1;
      relief->height_mm[at] = std::clamp(h[u], 0.0F, top);
    }
  }
  return relief;
}

}  // namespace hapticast::server
