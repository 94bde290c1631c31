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

constexpr double kClean_mm = 0.1;  // Chosen: at 0.5 N/mm and a usual range a force of a few mN.
// Chosen: four times the rounding error of float at 10 m. A fifth of the value that a sensor's
// noise, correlated over 2 px, yields at 0.6 m.
constexpr double kExact_mm = 0.002;
constexpr double kUnknown_mm = 0.5;  // chosen: between a clean and a usual sensor
// Apparent noise that rounding alone causes on a slope: second differences of one quantum, 1.48 /
// sqrt(6). Finer quanta yield the same value under a sensor's correlated noise.
constexpr double kRounding = 0.61;
constexpr double kLargestDifference_mm = 100.0;  // chosen: beyond, it is an edge
constexpr std::size_t kLargestNoiseBins = 400;   // 100 m, the largest valid depth
constexpr std::size_t kFewestInBin = 200;        // chosen: such a median is exact to a tenth
constexpr std::size_t kMostValues = 4000;        // more values do not improve the quantum
constexpr std::size_t kFewestGaps = 8;           // fewer gaps are of flat surfaces, not from a step
// Chosen: share of a step, and largest share of gaps off the lattice.
constexpr double kOffLattice = 0.1;
constexpr double kLargestQuantum_mm = 20.0;  // chosen: coarser than 8 bits over 5 m

// Absolute second and fourth differences along the rows for each bin of range, and all values that
// occur.
struct DepthStatistics {
  std::vector<std::vector<double>> differences{1};
  std::vector<std::vector<double>> fourths{1};
  std::set<float> values;
};

DepthStatistics computeStatistics(const cv::Mat& depth) {
  DepthStatistics out;
  for (int v = 0; v < depth.rows; v += 2) {
    const auto* row = depth.ptr<float>(v);
    for (int u = 1; u + 1 < depth.cols; u += 2) {
      const float z = row[u];
      if (z <= 0 || row[u - 1] <= 0 || row[u + 1] <= 0) continue;
      const double second = std::abs(double(row[u - 1]) - 2 * double(z) + double(row[u + 1]));
      const auto bin = static_cast<std::size_t>(double(z) / DepthNoise::kBin_mm);
      if (second > kLargestDifference_mm || bin >= kLargestNoiseBins) continue;
      if (bin >= out.differences.size()) {
        out.differences.resize(bin + 1);
        out.fourths.resize(bin + 1);
      }
      out.differences[bin].push_back(second);
      if (u >= 2 && u + 2 < depth.cols && row[u - 2] > 0 && row[u + 2] > 0) {
        out.fourths[bin].push_back(std::abs(double(row[u - 2]) - 4 * double(row[u - 1]) +
                                            6 * double(z) - 4 * double(row[u + 1]) +
                                            double(row[u + 2])));
      }
      if (out.values.size() < kMostValues) out.values.insert(z);
    }
  }
  return out;
}

double findQuantum(const std::set<float>& values) {
  std::vector<double> gaps;
  for (auto next = values.begin(); next != values.end() && std::next(next) != values.end();
       ++next) {
    gaps.push_back(double(*std::next(next)) - double(*next));
  }
  if (gaps.size() < kFewestGaps) return 0.0;
  std::sort(gaps.begin(), gaps.end());
  const double least = gaps[gaps.size() / 20];
  const auto between = std::count_if(gaps.begin(), gaps.end(), [least](double gap) {
    return std::abs(gap / least - std::round(gap / least)) > kOffLattice;
  });
  // A clean depth has any value: then the smallest gap is not a step.
  if (static_cast<double>(between) > kOffLattice * static_cast<double>(gaps.size())) return 0.0;
  return std::min(kLargestQuantum_mm, computeMedian(gaps));
}

// The curvature of a clean surface is in the second differences, hardly in the fourth. The fourth
// differences underestimate correlated noise, so they count only where they show no noise at all.
double estimateSigma(std::vector<double>& seconds, std::vector<double>& fourths) {
  const double sigma = sigmaByMedian(seconds) / std::sqrt(6.0);
  if (fourths.size() < kFewestInBin) return sigma;
  const double unbent = sigmaByMedian(fourths) / std::sqrt(70.0);
  return unbent <= kExact_mm ? std::min(sigma, unbent) : sigma;
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
  DepthStatistics statistics = computeStatistics(depth);
  DepthNoise noise;
  std::optional<double> last;
  for (std::size_t i = 0; i < statistics.differences.size(); ++i) {
    const bool known = statistics.differences[i].size() >= kFewestInBin;
    const bool nearest = !last && known;
    if (known) last = estimateSigma(statistics.differences[i], statistics.fourths[i]);
    // Ranges nearer than the nearest measured bin are not noisier than that bin.
    if (nearest) std::fill(noise.sigma_mm.begin(), noise.sigma_mm.end(), *last);
    noise.sigma_mm.push_back(last.value_or(kUnknown_mm));
  }
  noise.quantum_mm = findQuantum(statistics.values);
  for (double& sigma : noise.sigma_mm) sigma = std::max(sigma, 0.5 * noise.quantum_mm);
  return noise;
}

}  // namespace hapticast::server
