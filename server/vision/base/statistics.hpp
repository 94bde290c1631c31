// SPDX-License-Identifier: MIT
// Robust statistics, which outliers hardly change: median, quantiles, median absolute deviation
// (Rousseeuw and Croux 1993) and midmean. Thread: any.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace hapticast::server {

/// Returns the median of `values`. Of an even number of values it is the upper one of the middle
/// two. Returns 0 if `values` is empty. Reorders `values`.
template <class Value>
double computeMedian(std::vector<Value>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// Returns the `share`-quantile of `values`: the value with the share `share` (0..1) of all values
/// below it. Requires at least one value. Reorders `values`.
template <class Value>
double computeQuantile(std::vector<Value>& values, double share) {
  const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

/// Returns the standard deviation of normally distributed noise from its absolute deviations. It is
/// 1.48 times their median (1 / 0.6745, Rousseeuw and Croux 1993). Returns 0 if there are none.
/// Reorders `absolute_deviations`.
template <class Value>
double sigmaByMedian(std::vector<Value>& absolute_deviations) {
  return 1.48 * computeMedian(absolute_deviations);
}

/// Returns the mean of the middle half of `values` (midmean), or 0 if there are none. Outliers do
/// not change it, as long as at most a quarter of the values at each end are outliers. Unlike a
/// median, it does not jump between rounded values. Reorders `values`.
template <class Value>
double computeMiddleMean(std::vector<Value>& values) {
  if (values.empty()) return 0.0;
  const auto quarter = static_cast<std::ptrdiff_t>(values.size() / 4);
  const auto first = values.begin() + quarter;
  const auto last = values.end() - quarter;
  std::nth_element(values.begin(), first, values.end());
  if (quarter > 0) std::nth_element(first, last - 1, values.end());
  return static_cast<double>(std::accumulate(first, last, Value{})) /
         static_cast<double>(last - first);
}

}  // namespace hapticast::server
