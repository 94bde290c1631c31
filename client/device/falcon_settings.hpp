// SPDX-License-Identifier: MIT
// What a user may say about a Falcon (--falcon-...).
#pragma once

#include <string>

namespace hapticast::client {

/// What was measured of a stock driver's frames fits 3500 counts a N m at the arm; other drivers
/// send three times as much. Every device is a little different.
inline constexpr double kFalconGain = 3500.0;

struct FalconSettings {
  std::string firmware_file = {};  ///< empty: the usual place, or what already runs
  std::string serial = {};         ///< empty: the first one
  double gain = kFalconGain;       ///< counts a N m at the arm
  bool event_character = true;     ///< off: only to measure what it brings
};

}  // namespace hapticast::client
