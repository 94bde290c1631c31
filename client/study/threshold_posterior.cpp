// SPDX-License-Identifier: MIT
#include "client/study/threshold_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace hapticast::client {

namespace {

constexpr double kLeastSlope = 0.7;
constexpr double kMostSlope = 7.0;
// An answer that a hypothesis excludes leaves it this likelihood, so that no posterior becomes
// zero.
constexpr double kLeastLikelihood = 1e-6;

}  // namespace

void LevelRange::requireValid() const {
  if (!(least > 0.0) || !(most > least) || !std::isfinite(most))
    throw std::invalid_argument("the range of levels needs 0 < least < most");
}

ThresholdPosterior::ThresholdPosterior(const LevelRange& range, const PsychometricFunction& assumed)
    : range_(range), assumed_(assumed) {
  range.requireValid();
  for (std::size_t s = 0; s < kSlopes; ++s) {
    const double share = static_cast<double>(s) / static_cast<double>(kSlopes - 1);
    slopes_[s] = kLeastSlope * std::pow(kMostSlope / kLeastSlope, share);
  }
  for (auto& row : probability_) row.fill(1.0 / static_cast<double>(kThresholds * kSlopes));
}

double ThresholdPosterior::threshold(double index) const {
  const double share = index / static_cast<double>(kThresholds - 1);
  return range_.least * std::pow(range_.most / range_.least, share);
}

void ThresholdPosterior::update(const StudyAnswer& answer) {
  double sum = 0.0;
  PsychometricFunction hypothesis = assumed_;
  for (std::size_t t = 0; t < kThresholds; ++t) {
    hypothesis.threshold = threshold(static_cast<double>(t));
    for (std::size_t s = 0; s < kSlopes; ++s) {
      hypothesis.slope = slopes_[s];
      const double correct = hypothesis.computeCorrect(answer.level);
      probability_[t][s] *= std::max(answer.is_correct ? correct : 1.0 - correct, kLeastLikelihood);
      sum += probability_[t][s];
    }
  }
  for (auto& row : probability_) {
    for (double& probability : row) probability /= sum;
  }
}

double ThresholdPosterior::computeQuantile(double probability) const {
  double below = 0.0;
  for (std::size_t t = 0; t < kThresholds; ++t) {
    const auto& row = probability_[t];
    const double here = std::accumulate(row.begin(), row.end(), 0.0);
    if (below + here >= probability && here > 0.0)  // linear within the step
      return threshold(static_cast<double>(t) - 0.5 + (probability - below) / here);
    below += here;
  }
  return range_.most;
}

}  // namespace hapticast::client
