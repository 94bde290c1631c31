// SPDX-License-Identifier: MIT
// Bayesian estimate of a threshold from the answers of one subject (Watson, Pelli 1983; with an
// unknown slope as in Kontsevich, Tyler 1999). A grid has the posterior of the logarithm of the
// threshold and of the slope. Each answer multiplies the posterior by its likelihood. The prior is
// flat in both.
// Thread: one.
#pragma once

#include <array>
#include <cstddef>

#include "client/study/psychometric_function.hpp"

namespace hapticast::client {

/// Range of stimulus levels of a study.
struct LevelRange {
  double least = 0.0;
  double most = 0.0;

  /// Throws std::invalid_argument unless 0 < `least` < `most` < infinity.
  void requireValid() const;
};

class ThresholdPosterior {
 public:
  /// Starts with the prior: each threshold of `range` is as likely as another one on a logarithmic
  /// scale. `assumed` has the guess rate and the lapse rate; its threshold and slope are not used.
  /// Throws std::invalid_argument as LevelRange::requireValid() does.
  ThresholdPosterior(const LevelRange& range, const PsychometricFunction& assumed);

  /// Includes one answer. Requires a level >= 0.
  void update(const StudyAnswer& answer);
  /// Returns the threshold below which the share `probability` of the posterior lies, in the unit
  /// of the level. Requires 0 < `probability` < 1. The estimate of the threshold is the median.
  [[nodiscard]] double computeQuantile(double probability) const;
  [[nodiscard]] double computeMedian() const { return computeQuantile(0.5); }

 private:
  // Chosen: a step is 5 % of the threshold where the range spans a factor of 100. Quantiles are
  // interpolated within a step.
  static constexpr std::size_t kThresholds = 101;
  // Chosen: slopes of 0.7 to 7 in equal ratios. A Gaussian observer in a 2AFC has about 1.3.
  static constexpr std::size_t kSlopes = 8;

  [[nodiscard]] double threshold(double index) const;

  LevelRange range_;
  PsychometricFunction assumed_;
  std::array<double, kSlopes> slopes_{};
  std::array<std::array<double, kSlopes>, kThresholds> probability_{};  // its sum is 1
};

}  // namespace hapticast::client
