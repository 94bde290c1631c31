// SPDX-License-Identifier: MIT
// Settings of a Falcon: the options of its driver.
// Thread: any.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::client {

/// Default gain: motor counts for each N m at the arm. The value was measured: recorded motor
/// counts of an unmodified driver correspond to 3500. Other drivers send three times as many
/// counts, and devices differ slightly.
inline constexpr double kFalconGain = 3500.0;
// Range of the gain. Chosen: far below the default, and twice the largest gain of other drivers.
inline constexpr double kLeastFalconGain = 100.0;
inline constexpr double kMostFalconGain = 20000.0;

/// Returns the gain in `text`, or nullopt if `text` is no number from kLeastFalconGain to
/// kMostFalconGain.
inline std::optional<double> parseFalconGain(std::string_view text) {
  return parseNumberInRange<double>(text, kLeastFalconGain, kMostFalconGain);
}

struct FalconSettings {
  /// Firmware that the client loads if none runs. Empty: usualFalconFirmware(), if it exists.
  std::string firmware_file = {};
  std::string serial = {};      ///< serial number of the device; empty: the first device
  double gain = kFalconGain;    ///< motor counts for each N m at the arm
  bool event_character = true;  ///< see falconRuns(); false is only for measurements
};

}  // namespace hapticast::client
