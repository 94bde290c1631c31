// SPDX-License-Identifier: MIT
// Playout clock: converts local time to play time on the server's media clock. While a force acts,
// it changes the pace of play time only a little.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/user_controls.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Times and limits of the stream. The network thread passes them to the loop. (The main thread
/// passes UserControls.) The struct owns no memory. Thread: network (writer), loop (reader of the
/// latest value).
struct StreamTiming {
  std::uint64_t number = 0;  ///< counts the values of one run, from 1; 0: the initial value
  bool connected = false;  ///< the welcome of the server has arrived, and its clock is synchronised
  /// First client-side epoch of this connection. The loop drops frames of earlier epochs.
  std::uint32_t first_epoch = 0;
  Duration clock_offset{0};          ///< media clock - local clock, at present
  Duration pipeline_latency{0};      ///< delay of vision, as the welcome states it
  Duration playout_delay_target{0};  ///< playout delay that is long enough for the recent jitter
  Duration frame_interval{40'000'000};
  Workspace workspace;
  /// Largest acceleration of the content; 0: the server states none.
  double largest_acceleration_mm_s2 = 0.0;
  double author_mass_kg = 0.0;  ///< mass of the object by its author; 0: the author states none
};

/// Computes play time: media clock - pipeline latency - playout delay.
///
/// While a force acts, play time approaches changed targets slowly, so that it never jumps under
/// the hand. Together the corrections of the clock offset and of the delay change play time by at
/// most 2 % of the elapsed time. Without a force play time changes at once. Within a connection
/// play time never decreases. If its target is earlier, play time stops until the target has
/// reached it.
class Playout {
 public:
  /// Returns play time of this tick. `now` is the local time and may have any value. `in_contact`
  /// is true if a force acts. While `user` pauses the stream, play time does not change.
  ///
  /// A new connection has another stream.first_epoch. Play time then starts again, as soon as the
  /// new clock is synchronised. Without a connection play time continues with the last offset and
  /// delay. Before the first connection it is 0.
  MediaTime advance(LocalTime now, const StreamTiming& stream, bool in_contact,
                    const UserControls& user = {}) noexcept;
  /// Makes play time start again at the next tick with a connection, as for a new connection.
  void resync() noexcept { resync_ = true; }
  /// Returns the playout delay in use.
  [[nodiscard]] Duration delay() const noexcept { return delay_; }

 private:
  bool running_ = false;  // a connection has existed
  bool resync_ = false;
  std::uint32_t first_epoch_ = 0;
  LocalTime last_{};
  Duration delay_{0};
  Duration offset_{0};  // clock offset - pipeline latency, as it approaches its target
  MediaTime last_play_{};
};

}  // namespace hapticast::client
