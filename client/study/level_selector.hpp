// SPDX-License-Identifier: MIT
// Psychophysical methods: each selects the stimulus level of the next trial from the answers
// before it.
//
// * Constant stimuli: fixed levels, each equally often, in random order.
// * Staircase, n up m down (Levitt 1971): n wrong answers in a row raise the level by a factor, m
//   correct ones lower it. One up three down settles where 79 % of the answers are correct.
// * QUEST (Watson, Pelli 1983): the level is the median of the threshold's posterior.
//
// A threshold_posterior estimates the threshold from the answers of each of them.
// To add a method, add a class in this file. Thread: one.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "client/study/threshold_posterior.hpp"

namespace hapticast::client {

class LevelSelector {
 public:
  virtual ~LevelSelector() = default;
  /// Returns the level of the next trial, in the unit of the study's variable. The level stays the
  /// same until the next onAnswer().
  [[nodiscard]] virtual double selectLevel() const = 0;
  /// Includes the answer to the trial at the selected level.
  virtual void onAnswer(bool is_correct) = 0;
};

/// Returns the method of constant stimuli. Each block has each of `levels` once, in an order by
/// `seed`. Throws std::invalid_argument without levels.
[[nodiscard]] std::unique_ptr<LevelSelector> makeConstantStimuli(std::vector<double> levels,
                                                                 std::uint64_t seed);

struct StaircaseSettings {
  LevelRange range;     ///< the level stays within
  double start = 0.0;   ///< level of the first trial
  int up = 1;           ///< wrong answers in a row that raise the level, 1 or more
  int down = 3;         ///< correct answers in a row that lower the level, 1 or more
  double factor = 1.2;  ///< ratio of two neighbouring levels, above 1
};
/// Returns a staircase. Throws std::invalid_argument if a setting is out of its range.
[[nodiscard]] std::unique_ptr<LevelSelector> makeStaircase(const StaircaseSettings& settings);

/// Returns QUEST over `range`, with the guess rate and lapse rate of `assumed`. Throws as
/// ThresholdPosterior does.
[[nodiscard]] std::unique_ptr<LevelSelector> makeQuest(const LevelRange& range,
                                                       const PsychometricFunction& assumed);

}  // namespace hapticast::client
