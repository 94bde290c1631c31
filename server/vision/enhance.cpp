// SPDX-License-Identifier: MIT
#include "server/vision/enhance.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr int kRim_px = 5;
constexpr int kSweeps = 60;
constexpr double kSmooth_mm = 0.65;
constexpr double kThesisSigma_px = 2.0;

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

bool background(double z, double object, double behind, double sigma) {
  const double gap = behind - object;
  if (std::abs(gap) <= 15 + 6 * sigma) return false;  // contact: nothing to tell them apart by
  const double off = z - object;
  const bool same_side = off * gap > 0;
  if (same_side) return std::abs(z - behind) < std::abs(off) && std::abs(off) > 12 + 4 * sigma;
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

// Of the pixels `known` (measured, inside `mask`): those that are the object's.
cv::Mat gated(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
              const DepthNoise& noise) {
  const cv::Mat core = erodedBy(mask, kRim_px);
  const cv::Mat core_known = core & known;
  const cv::Mat around = (dilatedBy(mask, kRim_px) == 0) & (depth > 0);
  const bool two_sides = cv::countNonZero(core_known) >= 20 && cv::countNonZero(around) >= 20;
  const cv::Mat object = two_sides ? filledAtHalfSize(depth, core_known) : cv::Mat();
  const cv::Mat behind = two_sides ? filledAtHalfSize(depth, around) : cv::Mat();
  cv::Mat keep = known.clone();
  for (int v = 0; v < depth.rows; ++v) {
    const auto* is_known = known.ptr<unsigned char>(v);
    const auto* is_core = core.ptr<unsigned char>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (is_known[u] == 0) continue;
      const auto z = double(depth.at<float>(v, u));
      const double sigma = noise.at(z);
      const bool rim = is_core[u] == 0;
      const bool drop = (rim && two_sides &&
                         background(z, double(object.at<float>(v / 2, u / 2)),
                                    double(behind.at<float>(v / 2, u / 2)), sigma)) ||
                        lonely(depth, known, u, v, sigma, rim ? 2 : 3);
      if (drop) keep.at<unsigned char>(v, u) = 0;
    }
  }
  return keep;
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

Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method) {
  const cv::Rect tight = boxAround(mask, 0);
  const cv::Rect wide = boxAround(mask, 3 * kRim_px);
  const cv::Rect inner(tight.tl() - wide.tl(), tight.size());
  const cv::Mat object = mask(wide);
  const cv::Mat near_depth = depth(wide);
  const cv::Mat known = object & (near_depth > 0);
  if (method == Method::kThesis) {
    return {tight, object(inner).clone(), near_depth(inner).clone(), known(inner).clone()};
  }
  const cv::Mat measured = gated(near_depth, object, known, noise);
  const cv::Mat whole = filled(near_depth, measured, object);
  return {tight, object(inner).clone(), whole(inner).clone(), measured(inner).clone()};
}

std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method) {
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
    const double sigma_px = std::clamp(kSmooth_mm / workspace.mmPerPixel().maxCoeff(), 0.8, 8.0);
    height = quadraticFit(height, surface.mask, sigma_px);
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
