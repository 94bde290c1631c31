// SPDX-License-Identifier: MIT
// Playout clock: converts local time to play time on the media clock, with a slew-rate limit under
// the hand.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/user_controls.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

// Input of the loop from the network: the times and the limits of the stream. The other input is
// UserControls.
// Thread: network (writer), loop (reader of the latest value).

/// Times and limits of the stream, without ownership.
struct StreamTiming {
  bool connected = false;  ///< the stream is announced and its clock is synchronised
  /// First client-side epoch of this connection; frames of earlier epochs are void.
  std::uint32_t first_epoch = 0;
  Duration clock_offset{0};          ///< media clock - local clock, at present
  Duration pipeline_latency{0};      ///< announced by the server
  Duration playout_delay_target{0};  ///< playout delay that covers the recent jitter
  Duration frame_interval{40'000'000};
  Workspace workspace;
  double largest_acceleration_mm_s2 = 0.0;  ///< 0: not announced
  double author_mass_kg = 0.0;              ///< 0: no author's mass
};

/// Play time = media clock - pipeline latency - playout delay.
///
/// While a force acts, play time follows the targets of clock offset and delay at 2 % of its pace
/// in sum. So it never jumps under the hand. Without a force it follows at once. Within a
/// connection play time never runs backwards; it holds until the target time has caught up.
class Playout {
 public:
  /// Returns play time of this tick. `in_contact`: a force acts. A new connection
  /// (stream.first_epoch) starts over as soon as its clock is synchronised. A pause holds play
  /// time. Without a connection play time continues with the last offset and delay; before the
  /// first connection it is 0. `now` may have any value.
  MediaTime advance(LocalTime now, const StreamTiming& stream, bool in_contact,
                    const UserControls& user = {}) noexcept;
  /// Starts over at the next tick with a connection, like a new connection.
  void resync() noexcept { resync_ = true; }
  [[nodiscard]] Duration delay() const noexcept { return delay_; }

 private:
  bool running_ = false;  // there was a connection
  bool resync_ = false;
  std::uint32_t first_epoch_ = 0;
  LocalTime last_{};
  Duration delay_{0};
  Duration offset_{0};  // slewed target: clock offset - pipeline latency
  MediaTime last_play_{};
};

}  // namespace hapticast::client
