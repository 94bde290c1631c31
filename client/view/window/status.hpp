// SPDX-License-Identifier: MIT
// Status of the run in the window, as text and numbers.
// Thread: main.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "client/haptics/safety/safety_action.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// Statistics of the ticks for the panel.
class TickWatch {
 public:
  void add(const TickReport& report);
  [[nodiscard]] const TickReport& last() const { return last_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Ticks that began more than 1.5 ms after the tick before, as in the summary.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// Longest and mean tick of the last complete second.
  [[nodiscard]] double longest_us() const { return longest_us_; }
  [[nodiscard]] double mean_us() const { return mean_us_; }
  /// Safety actions of the last second as text.
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_us_ = 0.0;
  double mean_us_ = 0.0;
  // Of the present second:
  Duration second_longest_{0};
  Duration second_sum_{0};
  std::uint64_t second_ticks_ = 0;
  LocalTime second_begin_{};
  std::array<LocalTime, kInterferenceNames.size()> acted_{};
  std::array<bool, kInterferenceNames.size()> ever_{};
};

/// Returns a line such as "in contact, 1.2 N", or the reason of a missing force.
[[nodiscard]] std::string statusLine(const TickReport& report, const UiState& ui_state);

}  // namespace hapticast::client
