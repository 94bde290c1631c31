// SPDX-License-Identifier: MIT
// A study with people: its conditions, its question and the order of its trials. study_file.hpp
// reads it from a file.
// Thread: any; constant after start-up.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/haptics/user_controls.hpp"
#include "client/study/threshold_posterior.hpp"
#include "client/study/trial_order.hpp"
#include "common/json/json_error.hpp"

namespace hapticast::client {

/// What a subject touches in a trial.
struct Condition {
  std::string name;        ///< known to the analysis only: subject and experimenter see a code
  std::string recording;   ///< file of a recorded stream; empty: the stream of `server`
  std::string server;      ///< address of a hapticast-server; empty: `recording`
  double seconds = 10.0;   ///< length of an interval
  bool static_on = true;   ///< false: no static force
  bool dynamic_on = true;  ///< false: no dynamic force
  double stiffness = 1.0;  ///< factor of the stiffness, 0.1..3
  std::optional<double> mass_kg = std::nullopt;  ///< replaces the author's mass
  Method method = Method::kHapticast;
  SurfaceKind surface = SurfaceKind::kProxy;  ///< the thesis's method uses kPerturbed
  double delay_ms = 0.0;                      ///< how much later than the picture the force comes
  double jitter_ms = 0.0;  ///< each frame arrives late by a random time up to this one
  std::optional<double> pause_at_s = std::nullopt;  ///< frozen frame: play time stops from here on
  JsonPlace place;                                  ///< in the study file
};

enum class QuestionKind : std::uint8_t { kLikert, kVisualAnalogue, kForcedChoice };

/// The question after each trial.
struct Question {
  QuestionKind kind = QuestionKind::kLikert;
  std::string text;
  std::size_t steps = 7;  ///< answers of a Likert scale, 2..9
  std::string low, high;  ///< labels of the ends of a scale
};

/// Quantity that differs between the two intervals of a forced choice.
enum class Variable : std::uint8_t { kStiffness, kMass, kDelay };
enum class SelectorKind : std::uint8_t { kConstantStimuli, kStaircase, kQuest };

/// Two intervals of one condition: the first or the second one has reference + level.
struct Comparison {
  Variable variable = Variable::kStiffness;
  double reference = 1.0;  ///< in the unit of the variable: factor, kg, ms
  SelectorKind selector = SelectorKind::kQuest;
  LevelRange range;            ///< of the levels
  std::vector<double> levels;  ///< of the constant stimuli
  double start = 0.0;          ///< of the staircase, with the three below
  int up = 1;
  int down = 3;
  double factor = 1.2;
  double lapse = 0.02;  ///< assumed lapse rate of the subjects

  /// Returns the largest level that a trial can have.
  [[nodiscard]] double findLargestLevel() const;
};

struct Study {
  std::string name;     ///< task label of BIDS: letters and digits
  std::string consent;  ///< text before the first trial
  std::uint64_t seed = 0;
  TrialOrder order = TrialOrder::kRandomInBlocks;
  std::size_t blocks = 1;      ///< how often a subject gets each condition
  std::size_t training = 0;    ///< trials before the first one that counts
  std::size_t rest_every = 0;  ///< trials between two pauses; 0: none
  Question question;
  std::optional<Comparison> comparison;  ///< present: two intervals per trial
  std::vector<Condition> conditions;

  /// Returns the number of trials of a subject, with training and without repeated trials.
  [[nodiscard]] std::size_t countTrials() const { return training + blocks * conditions.size(); }
};

/// Returns whether `text` is a label of BIDS: letters and digits, at least one.
[[nodiscard]] bool isLabel(std::string_view text);
/// Returns `condition` with another value of `variable`.
[[nodiscard]] Condition withVariable(Condition condition, Variable variable, double value);

}  // namespace hapticast::client
