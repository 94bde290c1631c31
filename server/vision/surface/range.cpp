// SPDX-License-Identifier: MIT
#include "server/vision/surface/range.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// Shares of the pixels of a frame, and of the frames. Measured on clips of objects in hands whose
// masks leak. A quantile over all pixels would let 5 % of leaked background widen the range 28
// times.
constexpr double kFront = 0.01;
constexpr double kBack = 0.98;
constexpr double kFramesBeyond = 0.02;
constexpr double kOuter = 0.1;  // chosen: leaks are rarely a larger share of a mask
constexpr double kUsualReach =
    1.8;  // chosen, relative to the usual frame: the back of a ball is 1.45 times as far
constexpr double kSlack_mm = 20;     // chosen, added to that
constexpr double kSlackSteps = 4;    // chosen, of rounded depth
constexpr int kMixedRim_px = 3;      // measured: sensors mix object and background there
constexpr std::size_t kFewest = 50;  // chosen: pixels that determine an object's extent
constexpr double kLeast_mm = 50;     // chosen: two thirds are a ball of 70 mm
constexpr double kLeastSigmas = 60;  // chosen: one sigma of noise is half a mm of height
constexpr double kLeastSteps = 16;  // chosen: an object in 8-bit depth of a whole room has about 14
constexpr double kLeastSigmas8 = 20;
constexpr double kWide = 2.5;  // chosen, times the usual depth of an object

cv::Mat extractCore(const Surface& surface) {
  cv::Mat framed;
  cv::copyMakeBorder(surface.mask, framed, kMixedRim_px, kMixedRim_px, kMixedRim_px, kMixedRim_px,
                     cv::BORDER_CONSTANT, cv::Scalar(0));
  const cv::Rect inner({kMixedRim_px, kMixedRim_px}, surface.mask.size());
  return erodeBy(framed, kMixedRim_px)(inner) & surface.measured;
}

std::vector<float> collectDepths(const Surface& surface, const cv::Mat& where) {
  std::vector<float> out;
  out.reserve(where.total());
  for (int v = 0; v < where.rows; ++v) {
    const auto* inside = where.ptr<unsigned char>(v);
    const auto* depth = surface.depth.ptr<float>(v);
    for (int u = 0; u < where.cols; ++u) {
      if (inside[u] != 0) out.push_back(depth[u]);
    }
  }
  return out;
}

}  // namespace

void RangeFinder::add(std::uint32_t object, const Surface& surface, const DepthNoise& noise) {
  std::vector<float> depths = collectDepths(surface, extractCore(surface));
  if (depths.size() < kFewest) depths = collectDepths(surface, surface.measured);
  if (depths.empty()) return;
  Voice voice{computeQuantile(depths, kFront), computeQuantile(depths, 0.5),
              computeQuantile(depths, kBack)};
  voice.half_mm = std::max(voice.middle_mm - computeQuantile(depths, kOuter),
                           computeQuantile(depths, 1.0 - kOuter) - voice.middle_mm);
  voices_[object].push_back(voice);
  const double sigma_mm = noise.at(voice.middle_mm);
  const double least_mm = noise.eight_bit
                              ? std::max(kLeastSteps * noise.quantum_mm, kLeastSigmas8 * sigma_mm)
                              : std::max(kLeast_mm, kLeastSigmas * sigma_mm);
  least_mm_ = std::max(least_mm_, least_mm);
  slack_mm_ = noise.eight_bit ? kSlackSteps * noise.quantum_mm : kSlack_mm;
}

// Returns the largest plausible distance from an object's median depth, from the middle four fifths
// of its pixels, which rarely include leaks.
double RangeFinder::reach_mm(const std::vector<Voice>& voices) const {
  std::vector<double> halves_mm;
  halves_mm.reserve(voices.size());
  for (const Voice& voice : voices) halves_mm.push_back(voice.half_mm);
  return kUsualReach * computeMedian(halves_mm) + slack_mm_;
}

std::optional<MappedRange> RangeFinder::range(double margin) const {
  std::vector<double> nears_mm;
  std::vector<double> fars_mm;
  std::vector<double> spans_mm;
  for (const auto& [object, voices] : voices_) {
    const double reach = reach_mm(voices);
    for (const Voice& voice : voices) {
      nears_mm.push_back(std::max(voice.near_mm, voice.middle_mm - reach));
      fars_mm.push_back(std::min(voice.far_mm, voice.middle_mm + reach));
      spans_mm.push_back(fars_mm.back() - nears_mm.back());
    }
  }
  if (nears_mm.empty()) return std::nullopt;
  const double near = computeQuantile(nears_mm, kFramesBeyond);
  const double far = computeQuantile(fars_mm, 1.0 - kFramesBeyond);
  const double bulk_mm = (far - near) * (1 + 2 * margin);
  const double span = std::max(bulk_mm, least_mm_);
  const double middle = 0.5 * (near + far);
  MappedRange out;
  out.range = {middle - 0.5 * span, middle + 0.5 * span};
  out.usual_mm = computeMedian(spans_mm);
  out.wide = bulk_mm >= least_mm_ && bulk_mm > kWide * out.usual_mm;
  return out;
}

}  // namespace hapticast::server
