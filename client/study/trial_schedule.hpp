// SPDX-License-Identifier: MIT
// Trials of one subject, one after the other: training, then the conditions in their order. A void
// trial comes again at the end. In a forced choice a level_selector of each condition selects the
// levels from the answers. All of it follows from the study, the subject and the answers, so the
// answers of an interrupted run restore its state.
// Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/study/level_selector.hpp"
#include "client/study/study.hpp"

namespace hapticast::client {

struct Trial {
  std::size_t number = 1;  ///< counts all trials of a subject, from 1
  bool is_training = false;
  std::size_t condition = 0;                   ///< place in Study::conditions
  std::optional<double> level = std::nullopt;  ///< of a forced choice
  bool comparison_first = false;               ///< the first of two intervals has reference + level
  bool operator==(const Trial&) const = default;
};

/// Returns the number in the code of a subject, which selects the row of a Latin square. A code
/// with letters gets its FNV-1a hash.
[[nodiscard]] std::uint64_t toSubjectNumber(std::string_view subject);

class TrialSchedule {
 public:
  /// Plans the trials of the subject with the code `subject`. `study` must outlive this object.
  TrialSchedule(const Study& study, std::string_view subject);

  /// Returns the present trial; nullopt after the last one.
  [[nodiscard]] std::optional<Trial> findTrial() const;
  /// Ends the present trial. `is_correct`: the answer of a forced choice; else not used.
  void onAnswer(bool is_correct);
  /// Ends the present trial without a result: it comes again at the end.
  void onVoid();
  /// Returns the number of trials that are not finished, with the present one and the training.
  [[nodiscard]] std::size_t countRemaining() const { return waiting_.size(); }
  /// Returns the code of the condition at a place of Study::conditions: "A", "B" ..., in an order
  /// that is shuffled for each subject. So it hides the name.
  [[nodiscard]] const std::string& code(std::size_t condition) const { return codes_[condition]; }
  /// Returns the posterior of the threshold of a condition. Requires a study with a forced choice.
  [[nodiscard]] const ThresholdPosterior& posterior(std::size_t condition) const {
    return thresholds_[condition].posterior;
  }

 private:
  struct Waiting {
    std::size_t condition;
    bool is_training;
  };
  struct Threshold {
    std::unique_ptr<LevelSelector> selector;
    ThresholdPosterior posterior;
  };
  void end();

  const Study& study_;
  std::uint64_t subject_;
  std::deque<Waiting> waiting_;
  std::size_t number_ = 1;
  std::vector<std::string> codes_;
  std::vector<Threshold> thresholds_;  // by condition; empty without a forced choice
};

}  // namespace hapticast::client
