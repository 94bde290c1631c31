// SPDX-License-Identifier: MIT
// Reads the recordings of hapticast-server and hapticast-client (--record FILE.mcap).
//
// Contract
// - Content. A server's recording has the frames that it sent, and their pictures. A client's
//   recording has every tick of the run, and the frames and pictures as they arrived.
// - Time. A recording has one clock, in ns: media time in a server's recording, the client's local
//   clock in a client's. start_ns(), end_ns() and seek() use it. RecordedTick::time_s has the local
//   clock, and Frame::time_s media time.
// - Order. Frames and ticks come in the order of the file, each with a place of its own: nextTick()
//   changes nothing for nextFrame().
// - Damage. What a file has up to its first damage is valid: a program that was killed leaves a
//   recording without its last second. Then problem() has the cause. No error is thrown for it.
// - Trust. All bytes are checked before use. A Recording that was moved from must not be used.
// - Threads. One at a time. A Recording has no thread of its own.
// - Errors and units: frame.hpp.
//
// Example: print the largest force of a run.
//
//   hapticast::Recording recording("run.mcap");
//   double most_N = 0.0;
//   while (const auto tick = recording.nextTick())
//     most_N = std::fmax(most_N, tick->force_N.norm());
//   std::printf("%.2f N %s\n", most_N, recording.problem().c_str());
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hapticast/frame.hpp"

namespace hapticast {

/// A tick of hapticast-client. Positions and the penetration are in the nominal frame, forces in
/// the device frame.
struct RecordedTick {
  std::uint64_t tick = 0;        ///< number of the tick, from 1
  double time_s = 0.0;           ///< local clock of the client
  double play_time_s = 0.0;      ///< media time of the rendered instant
  double playout_delay_s = 0.0;  ///< time by which the client plays frames later, for the jitter
  Eigen::Vector3d reading_mm = Eigen::Vector3d::Zero();       ///< of the device, in its own frame
  Eigen::Vector3d hip_mm = Eigen::Vector3d::Zero();           ///< haptic interface point: the hand
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();          ///< force that was sent to the device
  Eigen::Vector3d static_force_N = Eigen::Vector3d::Zero();   ///< of the surface, before the limits
  Eigen::Vector3d dynamic_force_N = Eigen::Vector3d::Zero();  ///< of motion, within the limits
  double penetration_mm = 0.0;       ///< distance between hand and surface; 0 without contact
  std::uint32_t buttons = 0;         ///< a bit for each button of the device
  std::uint32_t safety_actions = 0;  ///< one bit for each name of listSafetyActions()
  std::uint8_t device = 0;           ///< 0: a new position, 1: no new position, 2: lost
  std::uint8_t lookup = 0;           ///< source of the surface: place in listLookups()
  std::uint8_t fault = 0;            ///< fault that began in the tick: place in listFaults()
  bool contact = false;              ///< true: the hand touches an object
  bool stopping = false;             ///< true: the force goes to zero at the end of the run
};

/// Return the names of RecordedTick::lookup and RecordedTick::fault. The first one is `none`.
[[nodiscard]] const std::vector<std::string>& listLookups();
[[nodiscard]] const std::vector<std::string>& listFaults();

/// Numbers of what a recording has up to its first damage.
struct RecordingCounts {
  std::uint64_t frames = 0;
  std::uint64_t ticks = 0;
  std::uint64_t pictures = 0;
  std::string problem = {};  ///< the first damage, such as "is cut off"; empty: none
};

/// A recording that is open for reading.
class Recording {
 public:
  /// The program that wrote a recording.
  enum class Kind : std::uint8_t { kServer, kClient };

  /// Opens `file`. Errors: std::runtime_error (the file cannot be read, is no MCAP file, or no
  /// recording of hapticast).
  explicit Recording(const std::string& file);
  ~Recording();
  Recording(Recording&& from) noexcept;
  Recording& operator=(Recording&& from) noexcept;

  [[nodiscard]] Kind kind() const;
  /// Return the times of the first and of the last message.
  [[nodiscard]] std::int64_t start_ns() const;
  [[nodiscard]] std::int64_t end_ns() const;
  /// Returns the properties of the stream at the last frame that nextFrame() returned, or at the
  /// begin of the recording. Returns nullopt if a client never connected.
  [[nodiscard]] const std::optional<StreamInfo>& info() const;
  /// Reads the whole file, and counts what nextFrame() and nextTick() return from its begin.
  [[nodiscard]] RecordingCounts count() const;

  /// Returns the next frame, with all its heights and its picture. Returns nullopt at the end.
  [[nodiscard]] std::optional<Frame> nextFrame();
  /// Returns the next tick. Returns nullopt at the end, and for a server's recording.
  [[nodiscard]] std::optional<RecordedTick> nextTick();
  /// Continues with the first frame and the first tick of `time_ns` or later. In a client's
  /// recording the next call of nextFrame() reads from the begin of the file to find all heights.
  void seek(std::int64_t time_ns);
  /// Returns why frames or ticks have ended before the end of the recording, such as "is cut off".
  /// Empty: they have not.
  [[nodiscard]] const std::string& problem() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast
