// SPDX-License-Identifier: MIT
#include "server/vision/surface/range.hpp"

#include <algorithm>

namespace hapticast::server {

void RangeFinder::add(const Surface& surface, const DepthNoise& noise) {
  double sum = 0.0;
  std::uint64_t count = 0;
  for (int v = 0; v < surface.depth.rows; ++v) {
    for (int u = 0; u < surface.depth.cols; ++u) {
      if (surface.measured.at<unsigned char>(v, u) == 0) continue;
      const auto z = double(surface.depth.at<float>(v, u));
      const auto bin = static_cast<std::size_t>(z / kBin_mm);
      if (bin >= bins_.size()) bins_.resize(bin + 1, 0);
      ++bins_[bin];
      sum += z;
      ++count;
    }
  }
  if (count > 0) sigma_mm_ = std::max(sigma_mm_, noise.at(sum / double(count)));
  count_ += count;
}

std::optional<DepthRange> RangeFinder::range(double margin) const {
  if (count_ == 0) return std::nullopt;
  const auto percentile = [&](double fraction) {
    const auto wanted = static_cast<std::uint64_t>(fraction * double(count_));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      seen += bins_[bin];
      if (seen > wanted) return double(bin) * kBin_mm;
    }
    return double(bins_.size()) * kBin_mm;
  };
  const double near = percentile(0.002);
  const double far = percentile(0.99) + kBin_mm;
  const double span = std::max({(far - near) * (1 + 2 * margin), 100.0, 60 * sigma_mm_});
  const double middle = 0.5 * (near + far);
  return DepthRange{middle - 0.5 * span, middle + 0.5 * span};
}

}  // namespace hapticast::server
