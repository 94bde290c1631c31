// SPDX-License-Identifier: MIT
// Psychometric function of a subject in a two-alternative forced choice (2AFC): the probability of
// a correct answer at a stimulus level. It is the Weibull function with a lapse rate
// (Wichmann, Hill 2001), with the threshold at half of the way from guessing to certainty:
//
//   p(x) = guess + (1 - guess - lapse) (1 - 2^-(x / threshold)^slope)
//
// Without lapses, p(threshold) is 0.75 in a 2AFC. That level is the just noticeable difference
// (JND), if the level is the difference between two stimuli.
// Thread: any.
#pragma once

#include <cmath>

namespace hapticast::client {

struct PsychometricFunction {
  double threshold = 1.0;  ///< above 0, in the unit of the level
  double slope = 2.0;      ///< exponent of the Weibull function, above 0
  double guess = 0.5;      ///< probability of a correct answer by chance, 0..1
  double lapse = 0.02;     ///< probability of a wrong answer at any level, 0..1 - guess

  /// Returns the probability of a correct answer at `level`, 0..1. Requires `level` >= 0.
  [[nodiscard]] double computeCorrect(double level) const {
    return guess + (1.0 - guess - lapse) * (1.0 - std::exp2(-std::pow(level / threshold, slope)));
  }
};

/// One answer of a subject.
struct StudyAnswer {
  double level = 0.0;  ///< stimulus level of the trial
  bool is_correct = false;
};

}  // namespace hapticast::client
