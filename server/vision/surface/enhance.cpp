// SPDX-License-Identifier: MIT
#include "server/vision/surface/enhance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/base/reduction.hpp"
#include "server/vision/surface/background_rejection.hpp"
#include "server/vision/surface/quadratic_fit.hpp"

namespace hapticast::server {

namespace {

constexpr double kSmooth_mm = 0.65;             // measured: 0.6 to 0.75 are equally good
constexpr std::array kWider_mm{1.0, 1.6, 2.6};  // chosen: each about 1.6 times its predecessor
constexpr double kFinest_px_mm = 12.0;          // chosen: limit of the window in fine pictures
constexpr double kThesisSigma_px = 2.0;         // as in the thesis
constexpr double kBeyondRange_mm = 3.0;         // chosen: range that a fit of a slope needs
constexpr double kFewestDepth = 0.02;  // chosen, of a mask: least share with depth for a surface

// Rounded depth: the true value lies within half a step. The fit is clamped to that where a rim is
// curved too much for it.
cv::Mat removeTerraces(const cv::Mat& fitted, const cv::Mat& rounded, const Surface& surface,
                       double half_mm, double px_per_mm) {
  cv::Mat out = fitted;
  for (const double sigma_mm : kWider_mm)
    out = fitWider(out, rounded, surface.mask, surface.measured, half_mm, sigma_mm * px_per_mm);
  cv::Mat kept;
  cv::max(out, rounded - half_mm, kept);
  cv::min(kept, rounded + half_mm, kept);
  out.copyTo(kept, surface.measured == 0);
  return kept;
}

cv::Mat thesisHeight(const cv::Mat& height, const Surface& surface, double depth_mm) {
  cv::Mat out = cv::max(cv::min(height, depth_mm), 0.0);
  out.setTo(0, (surface.mask == 0) | (surface.depth <= 0));
  const int margin = 8;  // the zero outside enters the smoothing
  cv::copyMakeBorder(out, out, margin, margin, margin, margin, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::GaussianBlur(out, out, {}, kThesisSigma_px);
  return out(cv::Rect({margin, margin}, surface.box.size()));
}

cv::Mat fitHeight(const cv::Mat& height, const Surface& surface, double mm_per_depth,
                  double px_per_mm) {
  cv::Mat fitted = fitQuadratic(height, surface.mask, std::max(0.8, kSmooth_mm * px_per_mm));
  if (!(surface.quantum_mm > 0)) return fitted;
  return removeTerraces(fitted, height, surface, 0.5 * mm_per_depth * surface.quantum_mm,
                        px_per_mm);
}

// Returns the heights inside the mask, clamped to 0 .. top_mm; 0 outside.
std::shared_ptr<const Relief> makeRelief(const cv::Mat& height, const Surface& surface,
                                         float top_mm) {
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
      relief->height_mm[at] = std::clamp(h[u], 0.0F, top_mm);
    }
  }
  return relief;
}

}  // namespace

Surface rawSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise) {
  const cv::Rect box = findBoxAround(mask, 0);
  const cv::Mat known = mask(box) & (depth(box) > 0);
  const bool rounded = noise.eight_bit && noise.clean(cv::mean(depth(box), known)[0]);
  return {box,
          mask(box).clone(),
          depth(box).clone(),
          known,
          rounded ? noise.quantum_mm : 0.0,
          computeReduction(box.size(), mask.size(), kLargestSurface_px)};
}

Surface cleanSurface(const cv::Mat& depth, const cv::Mat& mask, const DepthNoise& noise,
                     Method method, bool exact_mask) {
  Surface out = rawSurface(depth, mask, noise);
  if (method == Method::kThesis) {
    out.quantum_mm = 0.0;
    return out;
  }
  const cv::Rect wide = findBoxAround(mask, kGateReach_px);
  const cv::Rect inner(out.box.tl() - wide.tl(), out.box.size());
  const cv::Mat object = mask(wide);
  const cv::Mat near_depth = depth(wide);
  const cv::Mat known = object & (near_depth > 0);
  const bool trusted = exact_mask && contoursAgree(near_depth, object, known, noise);
  const cv::Mat measured =
      trusted ? known : foregroundPixels(near_depth, object, known, noise, out.reduction);
  out.depth = fillHoles(near_depth, measured, object, out.reduction)(inner).clone();
  out.measured = measured(inner).clone();
  return out;
}

Surface warpSurface(const cv::Mat& mask, const Surface& before, const cv::Matx23d& similarity) {
  Surface out;
  out.box = findBoxAround(mask, 0);
  out.mask = mask(out.box).clone();
  out.measured =
      warpImage(before.measured, before.box, out.box, similarity, cv::INTER_NEAREST) & out.mask;
  const cv::Mat depth = warpImage(before.depth, before.box, out.box, similarity, cv::INTER_NEAREST);
  out.reduction = computeReduction(out.box.size(), mask.size(), kLargestSurface_px);
  out.depth = fillHoles(depth, out.measured & (depth > 0), out.mask, out.reduction);
  out.quantum_mm = before.quantum_mm;
  return out;
}

bool hasDepth(const cv::Mat& depth, const cv::Mat& mask) {
  const cv::Rect box = findBoxAround(mask, 0);
  return cv::countNonZero(mask(box) & (depth(box) > 0)) >=
         kFewestDepth * cv::countNonZero(mask(box));
}

std::shared_ptr<const Relief> makeRelief(const Surface& surface, const DepthRange& range,
                                         const Workspace& workspace, Method method, bool smooth) {
  const double gain = workspace.depth_mm / (range.far_mm - range.near_mm);
  const auto top_mm = static_cast<float>(workspace.depth_mm);
  cv::Mat height;
  surface.depth.convertTo(height, CV_32F, -gain, gain * range.far_mm);
  if (method == Method::kThesis)
    return makeRelief(thesisHeight(height, surface, workspace.depth_mm), surface, top_mm);
  height.setTo(0, surface.depth <= 0);
  // Depths far beyond the range are mostly not the object's and must not affect fits beside them.
  height = cv::max(cv::min(height, workspace.depth_mm + kBeyondRange_mm), -kBeyondRange_mm);
  if (!smooth) return makeRelief(height, surface, top_mm);
  const double px_per_mm = std::min(kFinest_px_mm, 1.0 / workspace.mmPerPixel().maxCoeff());
  return makeRelief(fitHeight(height, surface, gain, px_per_mm), surface, top_mm);
}

}  // namespace hapticast::server
