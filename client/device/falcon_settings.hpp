// SPDX-License-Identifier: MIT
// Settings of a Falcon (--falcon-...).
// Thread: any.
#pragma once

#include <string>

namespace hapticast::client {

/// Default gain in counts/(N m) at the arm. Measured: the frames of a stock driver correspond to
/// 3500. Other drivers send three times as much, and devices differ slightly.
inline constexpr double kFalconGain = 3500.0;

struct FalconSettings {
  std::string firmware_file = {};  ///< empty: the default file, or firmware that already runs
  std::string serial = {};         ///< empty: the first device
  double gain = kFalconGain;       ///< counts/(N m) at the arm
  bool event_character = true;     ///< off: only to measure its effect
};

}  // namespace hapticast::client
