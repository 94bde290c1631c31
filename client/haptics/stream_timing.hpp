// SPDX-License-Identifier: MIT
// Input of the loop from the network: the times and the limits of the stream. The other input is
// UserControls.
// Thread: network (writer), loop (reader of the latest value).
#pragma once

#include <cstdint>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

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

}  // namespace hapticast::client
