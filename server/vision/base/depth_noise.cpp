// SPDX-License-Identifier: MIT
#include "server/vision/base/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr double kClean_mm = 0.1;    // chosen: at 0.5 N/mm and a usual range a few mN
constexpr double kUnknown_mm = 0.5;  // chosen: between a clean and a usual sensor
// What rounding alone reads as noise on a slope: second differences of one quantum, 1.48 / sqrt(6).
// Finer quanta read the same when a sensor's correlated noise is on them.
constexpr double kRounding = 0.61;
constexpr double kLargestDifference_mm = 100.0;  // chosen: beyond, it is an edge
constexpr std::size_t kLargestNoiseBins = 400;   // 100 m, the largest depth that counts
constexpr std::size_t kFewestInBin = 200;        // chosen: a median of so many is good to a tenth
constexpr std::size_t kMostValues = 4000;        // more of them tell no better quantum
constexpr std::size_t kFewestGaps = 8;           // between a few flat things gaps are no step
constexpr double kLargestQuantum_mm = 20.0;      // chosen: coarser than 8 bits over 5 m

// Absolute second differences along the rows, per bin of range, and the values that occur.
struct DepthStatistics {
  std::vector<std::vector<double>> differences{1};
  std::set<float> values;
};

DepthStatistics statisticsOf(const cv::Mat& depth) {
  DepthStatistics out;
  for (int v = 0; v < depth.rows; v += 2) {
    const auto* row = depth.ptr<float>(v);
    for (int u = 1; u + 1 < depth.cols; u += 2) {
      const float z = row[u];
      if (z <= 0 || row[u - 1] <= 0 || row[u + 1] <= 0) continue;
      const double second = std::abs(double(row[u - 1]) - 2 * double(z) + double(row[u + 1]));
      const auto bin = static_cast<std::size_t>(double(z) / DepthNoise::kBin_mm);
      if (second > kLargestDifference_mm || bin >= kLargestNoiseBins) continue;
      if (bin >= out.differences.size()) out.differences.resize(bin + 1);
      out.differences[bin].push_back(second);
      if (out.values.size() < kMostValues) out.values.insert(z);
    }
  }
  return out;
}

double quantumOf(const std::set<float>& values) {
  std::vector<double> gaps;
  for (auto next = values.begin(); next != values.end() && std::next(next) != values.end();
       ++next) {
    gaps.push_back(double(*std::next(next)) - double(*next));
  }
  return gaps.size() < kFewestGaps ? 0.0 : std::min(kLargestQuantum_mm, medianOf(gaps));
}

}  // namespace

double DepthNoise::at(double depth_mm) const {
  const auto bin = static_cast<std::size_t>(std::max(0.0, depth_mm / kBin_mm));
  return sigma_mm[std::min(bin, sigma_mm.size() - 1)];
}

double DepthNoise::step_mm(double depth_mm) const {
  return std::max({5.0, 6 * at(depth_mm), 1.5 * quantum_mm});
}

bool DepthNoise::clean(double depth_mm) const {
  return at(depth_mm) <= std::max(kClean_mm, eight_bit ? kRounding * quantum_mm : 0.0);
}

DepthNoise measureNoise(const cv::Mat& depth) {
  DepthStatistics statistics = statisticsOf(depth);
  DepthNoise noise;
  std::optional<double> last;
  for (auto& bin : statistics.differences) {
    const bool nearest = !last && bin.size() >= kFewestInBin;
    if (bin.size() >= kFewestInBin) last = sigmaByMedian(bin) / std::sqrt(6.0);
    // What comes nearer than anything was is not noisier.
    if (nearest) std::fill(noise.sigma_mm.begin(), noise.sigma_mm.end(), *last);
    noise.sigma_mm.push_back(last.value_or(kUnknown_mm));
  }
  noise.quantum_mm = quantumOf(statistics.values);
  for (double& sigma : noise.sigma_mm) sigma = std::max(sigma, 0.5 * noise.quantum_mm);
  return noise;
}

}  // namespace hapticast::server
