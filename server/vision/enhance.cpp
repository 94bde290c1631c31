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

// The measured pixels of the mask that hang together with at least `wanted` of their eight
// neighbours.
bool lonely(const cv::Mat& depth, const cv::Mat& known, int u, int v, double sigma, int wanted) {
  const auto z = double(depth.at<float>(v, u));
  int near = 0;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const cv::Point at(u + du, v + dv);
      if ((du == 0 && dv == 0) || !cv::Rect({0, 0}, depth.size()).contains(at)) continue;
      if (known.at<unsigned char>(at) == 0) continue;
      near += std::abs(double(depth.at<float>(at)) - z) <= 8 + 5 * sigma ? 1 : 0;
    }
  }
  return near < wanted;
}

bool background(double z, double object, double behind, double sigma) {
  const double gap = behind - object;
  if (std::abs(gap) <= 15 + 6 * sigma) return false;  // contact: nothing to tell them apart by
  const double off = z - object;
  const bool same_side = off * gap > 0;
  if (same_side) return std::abs(z - behind) < std::abs(off) && std::abs(off) > 12 + 4 * sigma;
  return std::abs(off) > 60 + 6 * sigma;
}

// Of the pixels `known` (measured, inside `mask`): those that are the object's.
cv::Mat gated(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
              const DepthNoise& noise) {
  const cv::Mat core = erodedBy(mask, kRim_px);
  const cv::Mat core_known = core & known;
  const cv::Mat around = (dilatedBy(mask, kRim_px) == 0) & (depth > 0);
  const bool two_sides = cv::countNonZero(core_known) >= 20 && cv::countNonZero(around) >= 20;
  const cv::Mat object = two_sides ? filled(depth, core_known, cv::Mat()) : cv::Mat();
  const cv::Mat behind = two_sides ? filled(depth, around, cv::Mat()) : cv::Mat();
  cv::Mat keep = known.clone();
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (known.at<unsigned char>(v, u) == 0) continue;
      const auto z = double(depth.at<float>(v, u));
      const double sigma = noise.at(z);
      const bool rim = core.at<unsigned char>(v, u) == 0;
      const bool drop =
          (rim && two_sides &&
           background(z, double(object.at<float>(v, u)), double(behind.at<float>(v, u)), sigma)) ||
          lonely(depth, known, u, v, sigma, rim ? 2 : 3);
      if (drop) keep.at<unsigned char>(v, u) = 0;
    }
  }
  return keep;
}

}  // namespace

cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted) {
  if (cv::countNonZero(known) == 0) return values.clone();
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat out = pushPull(values.mul(weight), weight);
  if (wanted.empty()) return out;
  std::vector<cv::Point> holes;
  cv::findNonZero(wanted & (known == 0), holes);
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
  relief->height_mm.reserve(surface.mask.total());
  relief->mask.reserve(surface.mask.total());
  for (int v = 0; v < height.rows; ++v) {
    for (int u = 0; u < height.cols; ++u) {
      const bool inside = surface.mask.at<unsigned char>(v, u) != 0;
      relief->mask.push_back(inside ? 1 : 0);
      relief->height_mm.push_back(inside ? std::clamp(height.at<float>(v, u), 0.0F, top) : 0.0F);
    }
  }
  return relief;
}

}  // namespace hapticast::server
