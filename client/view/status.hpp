// SPDX-License-Identifier: MIT
// Status of the run for the window: statistics of the ticks, and lines for the user.
// Thread: one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// Statistics of the ticks for the panel.
class TickStatus {
 public:
  /// Adds the report of a tick.
  void add(const TickReport& report);
  /// Returns the last report.
  [[nodiscard]] const TickReport& last() const { return last_; }
  /// Returns the number of ticks.
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }
  /// Returns the number of ticks that began more than 1.5 ms after the tick before, as in the
  /// summary.
  [[nodiscard]] std::uint64_t lateTicks() const { return late_; }
  /// Return the longest and the mean computing time of a tick in the last complete second.
  [[nodiscard]] double longest_us() const { return longest_us_; }
  [[nodiscard]] double mean_us() const { return mean_us_; }
  /// Returns true if the device has rendered a force in contact.
  [[nodiscard]] bool hasTouched() const { return has_touched_; }
  /// Returns the safety actions of the last second as text, or "no action".
  [[nodiscard]] std::string chain() const;

 private:
  TickReport last_;
  std::uint64_t ticks_ = 0;
  std::uint64_t late_ = 0;
  double longest_us_ = 0.0;
  double mean_us_ = 0.0;
  bool has_touched_ = false;
  // For the present second:
  Duration second_longest_{0};
  Duration second_sum_{0};
  std::uint64_t second_ticks_ = 0;
  LocalTime second_begin_{};
  std::array<LocalTime, kSafetyActionNames.size()> acted_{};
  std::array<bool, kSafetyActionNames.size()> ever_{};
};

/// Returns the distance from the surface under the HIP up to the HIP, nominal mm. It is negative if
/// the HIP is below the surface, and empty if the HIP is not over an object.
[[nodiscard]] std::optional<double> surfaceGap_mm(const TickReport& report);

/// Returns a line about the touch such as "in contact, 1.2 N". If there is no force, the line
/// states the reason and the remedy. Before contact it states the distance to the surface.
[[nodiscard]] std::string touchLine(const TickReport& report, const UserControls& user);
/// Returns a line for the user. If the connection or the stream prevents a force, the line states
/// that. Otherwise the line is touchLine().
[[nodiscard]] std::string statusLine(const TickReport& report, const UiState& ui_state);

/// Returns a line for each safety state that holds, except for a halt, which the status line
/// states, and a line if the link carries fewer pictures than the stream has. The text is empty
/// without such a state.
[[nodiscard]] std::string stateLines(const TickReport& report, const ConnectionStats& stream = {});

/// Returns the request to the user, if there is one (UiState::request). Otherwise returns
/// a hint for the time before the first touch: the event for which the client waits, or how
/// to touch. Returns an empty text after the first touch, and if the status line states the remedy.
[[nodiscard]] std::string hintLine(const TickStatus& ticks, const UiState& ui_state);

}  // namespace hapticast::client
