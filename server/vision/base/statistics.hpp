// SPDX-License-Identifier: MIT
// Statistics that a few wild values cannot spoil. Thread: any.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace hapticast::server {

/// Median of `values`, the upper one of an even number; reorders them. 0 when there are none.
template <class Value>
double computeMedian(std::vector<Value>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

/// The standard deviation that normal noise of these absolute deviations has: 1.48 times their
/// median (the MAD; 1 / 0.6745, Rousseeuw and Croux 1993). Reorders them. 0 when there are none.
template <class Value>
double sigmaByMedian(std::vector<Value>& absolute_deviations) {
  return 1.48 * computeMedian(absolute_deviations);
}

/// The mean of the middle half of `values`: a quarter of them may be anything, and steps of rounded
/// values, by which a median would jump, do not show. Reorders them. 0 when there are none.
template <class Value>
double middleMean(std::vector<Value>& values) {
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
