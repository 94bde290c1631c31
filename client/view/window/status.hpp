// SPDX-License-Identifier: MIT
// What the window says of the run in words and numbers. Thread: main.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "client/haptics/safety/safety_action.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// What the ticks of a run were like, for the panel.
class TickWatch {
 public:
  void add(const TickReport& report);
  [[nodiscard]] const TickReport& last() const { return last_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Began more than 1.5 ms after the one before, as the summary counts them.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// The longest and the mean tick of the last whole second.
  [[nodiscard]] double longest_us() const { return longest_us_; }
  [[nodiscard]] double mean_us() const { return mean_us_; }
  /// What the safety chain did in the last second, in plain words.
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_us_ = 0.0;
  double mean_us_ = 0.0;
  // Of the second that runs.
  Duration second_longest_{0};
  Duration second_sum_{0};
  std::uint64_t second_ticks_ = 0;
  LocalTime second_begin_{};
  std::array<LocalTime, kInterferenceNames.size()> acted_{};
  std::array<bool, kInterferenceNames.size()> ever_{};
};

/// A plain line: "in contact, 1.2 N", or why there is no force.
[[nodiscard]] std::string statusLine(const TickReport& report, const UiState& ui_state);

}  // namespace hapticast::client
