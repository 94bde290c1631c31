// SPDX-License-Identifier: MIT
// Plausibility check of the readings of a driver. A driver is foreign code, so its data are as
// unreliable as data from the network. A reading with an impossible value counts as a missing
// reading. After 20 ticks without a reading the force fades out (client/haptics).
// Thread: loop of the client; findings: any.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "client/device/helper/shared_page.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

class StateCheck {
 public:
  /// A reason to reject a reading; toText() describes each one.
  enum class Finding : std::uint8_t { kNotFinite, kOutside, kTooFast, kTimeBack, kFuture, kStatus };
  static constexpr std::size_t kFindings = 6;

  /// `workspace_mm` is the size of the device's workspace.
  explicit StateCheck(const Vec3& workspace_mm) : workspace_mm_(workspace_mm) {}

  /// Restarts the check for a new helper process: the next reading has no predecessor.
  void restart() noexcept;
  /// Checks `reading`, and returns the state for the haptic loop. The status is kOk if the reading
  /// is new, plausible, and at most 20 ms old at the time `now`. Otherwise the position, the
  /// buttons and the time are those of the last accepted reading.
  DeviceState check(const DeviceReading& reading, LocalTime now) noexcept;
  /// Returns how often each finding occurred. Thread: any.
  [[nodiscard]] std::uint64_t count(Finding finding) const noexcept {
    return counts_[static_cast<std::size_t>(finding)].load(std::memory_order_relaxed);
  }

 private:
  [[nodiscard]] std::optional<Finding> findFault(const hapticast_state& state,
                                                 LocalTime now) const noexcept;

  Vec3 workspace_mm_;
  std::uint64_t number_ = 0;
  bool accepted_any_ = false;
  bool lost_ = false;
  DeviceState last_;  // the last accepted position
  std::array<std::atomic<std::uint64_t>, kFindings> counts_{};
};

/// Returns a description of the finding, for a line to the user.
const char* toText(StateCheck::Finding finding) noexcept;

}  // namespace hapticast::client
