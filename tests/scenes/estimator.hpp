// SPDX-License-Identifier: MIT
// The errors of a program that estimates depth, on exact frames: another scale and shift in each
// frame, and soft edges. Deterministic. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "server/source/child/depth_task.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server::test {

struct Estimator {
  EstimatedDepth kind = EstimatedDepth::kMetric;
  double scale = 0.01;                ///< standard deviation over the frames
  double shift = 0.01;                ///< likewise, as a share of the median depth
  int soft_px = 15;                   ///< width of an edge; 1: sharp
  DepthRange range = kRelativeRange;  ///< of a relative kind
  std::uint64_t seed = 1;
};

/// Returns what the program answers for `depth` (mm, every pixel measured).
inline cv::Mat estimateDepth(const cv::Mat& depth, const Estimator& estimator, cv::RNG& random) {
  cv::Mat out;
  cv::blur(depth, out, {estimator.soft_px, estimator.soft_px}, {-1, -1}, cv::BORDER_REPLICATE);
  if (estimator.kind == EstimatedDepth::kInverse) out = 1000.0 / out;
  const double middle = cv::mean(out)[0];
  const double scale = 1.0 + random.gaussian(estimator.scale);
  return out * scale + middle * random.gaussian(estimator.shift);
}

/// Returns `exact` with estimated depth, as a source with DepthTask delivers it, and without masks.
inline std::vector<RgbdFrame> estimateFrames(const std::vector<RgbdFrame>& exact,
                                             const Estimator& estimator) {
  cv::RNG random(estimator.seed);
  std::vector<RgbdFrame> out = exact;
  std::optional<RelativeDepthMap> map;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    cv::Mat depth = estimateDepth(exact[i].depth, estimator, random);
    if (estimator.kind != EstimatedDepth::kMetric) {
      if (!map) map.emplace(depth, estimator.kind, estimator.range);
      depth = map->convert(depth);
    }
    out[i].depth = depth;
    out[i].mask = cv::Mat();
  }
  return out;
}

}  // namespace hapticast::server::test
