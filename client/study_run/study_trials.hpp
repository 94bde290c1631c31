// SPDX-License-Identifier: MIT
// The trials of one subject: prompts, intervals, answers, and a row of results per trial. A void
// trial (stop key, lost device, lost stream) gets a row, too, and comes again at the end.
// Thread: main.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "client/study/events_file.hpp"
#include "client/study/simulated_observer.hpp"
#include "client/study/trial_schedule.hpp"
#include "client/study_run/trial_player.hpp"

namespace hapticast::client {

/// Shows the consent text of `study`. Returns true if the subject agrees. Call it before the loop
/// of `player` starts and before a file exists.
[[nodiscard]] bool askConsent(const Study& study, TrialPlayer& player);

class StudyTrials {
 public:
  struct Parts {
    const Study& study;
    TrialSchedule& schedule;
    EventsFile& events;
    TrialPlayer& player;
    const std::optional<SimulatedObserver>& observer;  ///< answers in place of the subject
    /// Receives a line for each event.
    std::function<void(const std::string& event)> on_event;
  };
  explicit StudyTrials(const Parts& parts) : parts_(parts) {}

  /// Runs all trials, and thanks. Returns true if the study is complete. Throws
  /// std::runtime_error (one line) if the results cannot be written.
  [[nodiscard]] bool run();

 private:
  [[nodiscard]] bool prepare(const Trial& trial);
  [[nodiscard]] bool announce(int interval);
  [[nodiscard]] TrialEnd playIntervals(const Trial& trial, TrialRow& row);
  [[nodiscard]] TrialEnd askQuestion(const Trial& trial, TrialRow& row);
  /// Runs a trial, and writes its row. Returns how it ended.
  TrialEnd runTrial(const Trial& trial);
  [[nodiscard]] bool recover(TrialEnd end);
  [[nodiscard]] bool restDevice();
  std::optional<StudyInput> ask(const StudyPrompt& prompt);

  Parts parts_;
  std::size_t since_rest_ = 0;
  bool is_void_ = false;  // the last trial
};

}  // namespace hapticast::client
