// SPDX-License-Identifier: MIT
// The motion file of a subject (Motion-BIDS *_motion.tsv): one row per tick, without a header. Its
// columns are the rows of *_channels.tsv.
// Thread: one.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// A channel as in *_channels.tsv.
struct MotionChannel {
  const char* name;
  const char* component;  ///< x, y, z or n/a
  const char* type;       ///< of BIDS: POS, MISC, LATENCY
  const char* point;      ///< what is tracked
  const char* units;
  const char* description;
};

inline constexpr std::array<MotionChannel, 15> kMotionChannels{
    {{"latency", "n/a", "LATENCY", "n/a", "s", "time since the start of the recording"},
     {"hip_x", "x", "POS", "hip", "mm", "haptic interface point, nominal frame"},
     {"hip_y", "y", "POS", "hip", "mm", "haptic interface point, nominal frame"},
     {"hip_z", "z", "POS", "hip", "mm", "haptic interface point, nominal frame"},
     {"force_x", "x", "MISC", "hip", "N", "force sent to the device, device frame"},
     {"force_y", "y", "MISC", "hip", "N", "force sent to the device, device frame"},
     {"force_z", "z", "MISC", "hip", "N", "force sent to the device, device frame"},
     {"static_x", "x", "MISC", "hip", "N", "static force before the limits"},
     {"static_y", "y", "MISC", "hip", "N", "static force before the limits"},
     {"static_z", "z", "MISC", "hip", "N", "static force before the limits"},
     {"dynamic_x", "x", "MISC", "hip", "N", "dynamic force before the limits"},
     {"dynamic_y", "y", "MISC", "hip", "N", "dynamic force before the limits"},
     {"dynamic_z", "z", "MISC", "hip", "N", "dynamic force before the limits"},
     {"penetration", "n/a", "MISC", "hip", "mm", "distance from the surface to the point in it"},
     {"contact", "n/a", "MISC", "hip", "n/a", "1 in contact, else 0"}}};

/// Largest size of a row. The free space of the disk is checked with it.
inline constexpr std::size_t kMotionRow_bytes = 160;

class MotionFile {
 public:
  /// Opens `file` to append rows. A last row without its line end is dropped. Throws
  /// std::runtime_error with one line that names the file.
  explicit MotionFile(const std::filesystem::path& file);

  /// Appends a tick at `time_s` since the start of the recording.
  void append(const TickReport& report, double time_s);
  /// Writes the rows to the disk. Throws std::runtime_error with one line at the first failure.
  void flush();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  bool is_reported_ = false;  // that a row cannot be written
};

}  // namespace hapticast::client
