// SPDX-License-Identifier: MIT
// The playout clock: local time -> play time on the media clock. Real-time room: noexcept, no heap,
// no locks.
#pragma once

#include "client/haptics/stream_timing.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Play time = media clock now - pipeline latency - playout delay. The delay follows its target at
/// a rate of at most 2 % while a force acts (so play time never jumps under the hand) and at once
/// when none does; a moving estimate of the clock offset is followed in the same way, both together
/// within the 2 %. Play time never runs backwards within a connection: where it would have to, it
/// stands still until the wanted time has caught up.
class Playout {
 public:
  /// Play time of this tick. `in_contact`: a force acts. A new connection (stream.first_epoch)
  /// starts over once its clock is known. While paused it stands still; without a connection it
  /// runs on with what it last knew (0 before the first). Any `now`.
  MediaTime advance(LocalTime now, const StreamTiming& stream, bool in_contact,
                    const UserControls& user = {}) noexcept;
  /// The next connected tick starts over like that of a new connection.
  void resync() noexcept { resync_ = true; }
  [[nodiscard]] Duration delay() const noexcept { return delay_; }

 private:
  bool running_ = false;  // was connected once
  bool resync_ = false;
  std::uint32_t first_epoch_ = 0;
  LocalTime last_{};
  Duration delay_{0};
  Duration offset_{0};  // followed clock offset - pipeline latency, slewed like the delay
  MediaTime last_play_{};
};

}  // namespace hapticast::client
