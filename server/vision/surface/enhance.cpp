// SPDX-License-Identifier: MIT
#include "server/vision/surface/enhance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/surface/fill.hpp"
#include "server/vision/surface/quadratic_fit.hpp"

namespace hapticast::server {

namespace {

constexpr int kRim_px = 5;           // measured: sensors mix object and background so far in
constexpr double kSmooth_mm = 0.65;  // measured: 0.6 to 0.75 are equally good
constexpr std::array kWider_mm{1.0, 1.6, 2.6};  // chosen: each about 1.6 times the one before
constexpr double kFinest_px_mm = 12.0;   // chosen: smoothed over no more pixels in finer pictures
constexpr double kThesisSigma_px = 2.0;  // of the thesis
constexpr double kMixed = 0.1;           // chosen, of the pixels at an edge
constexpr double kFewestDepth = 0.02;    // chosen, of a mask, to make a surface of
constexpr int kFewestBeside = 20;        // chosen: pixels that tell what is inside and what around

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
  if (cv::countNonZero(core_known) < kFewestBeside || cv::countNonZero(around) < kFewestBeside)
    return {};
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
cv::Mat withoutTerraces(const cv::Mat& fitted, const cv::Mat& rounded, const Surface& surface,
                        double half_mm, double px_per_mm) {
  cv::Mat out = fitted;
  for (const double sigma_mm : kWider_mm)
    out = widerFit(out, rounded, surface.mask, surface.measured, half_mm, sigma_mm * px_per_mm);
  cv::Mat kept;
  cv::max(out, rounded - half_mm, kept);
  cv::min(kept, rounded + half_mm, kept);
  out.copyTo(kept, surface.measured == 0);
  return kept;
}

cv::Mat thesisHeight(const cv::Mat& height, const Surface& surface, double depth_mm) {
  cv::Mat out = cv::max(cv::min(height, depth_mm), 0.0);
  out.setTo(0, (surface.mask == 0) | (surface.depth <= 0));
  const int margin = 8;  // the zero outside is part of what is smoothed
  cv::copyMakeBorder(out, out, margin, margin, margin, margin, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::GaussianBlur(out, out, {}, kThesisSigma_px);
  return out(cv::Rect({margin, margin}, surface.box.size()));
}

cv::Mat fittedHeight(const cv::Mat& height, const Surface& surface, double mm_per_depth,
                     double px_per_mm) {
  cv::Mat fitted = quadraticFit(height, surface.mask, std::max(0.8, kSmooth_mm * px_per_mm));
  if (!(surface.quantum_mm > 0)) return fitted;
  return withoutTerraces(fitted, height, surface, 0.5 * mm_per_depth * surface.quantum_mm,
                         px_per_mm);
}

// Heights inside the mask, cut to 0 .. top_mm; 0 outside.
std::shared_ptr<const Relief> reliefFrom(const cv::Mat& height, const Surface& surface,
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

Surface carriedSurface(const cv::Mat& mask, const Surface& before, const cv::Matx23d& similarity) {
  Surface out;
  out.box = boxAround(mask, 0);
  out.mask = mask(out.box).clone();
  out.measured =
      carryImage(before.measured, before.box, out.box, similarity, cv::INTER_NEAREST) & out.mask;
  const cv::Mat depth =
      carryImage(before.depth, before.box, out.box, similarity, cv::INTER_NEAREST);
  out.depth = filled(depth, out.measured & (depth > 0), out.mask);
  out.quantum_mm = before.quantum_mm;
  return out;
}

bool hasDepth(const cv::Mat& depth, const cv::Mat& mask) {
  const cv::Rect box = boxAround(mask, 0);
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
    return reliefFrom(thesisHeight(height, surface, workspace.depth_mm), surface, top_mm);
  height.setTo(0, surface.depth <= 0);
  if (!smooth) return reliefFrom(height, surface, top_mm);
  const double px_per_mm = std::min(kFinest_px_mm, 1.0 / workspace.mmPerPixel().maxCoeff());
  return reliefFrom(fittedHeight(height, surface, gain, px_per_mm), surface, top_mm);
}

}  // namespace hapticast::server
