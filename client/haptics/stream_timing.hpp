// SPDX-License-Identifier: MIT
// One of the two doors through which the loop is told what to do: what is known of the stream.
#pragma once

#include <cstdint>

#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// The network writes it, the loop reads the latest value. A plain value that owns nothing.
struct StreamTiming {
  bool connected = false;  ///< a stream is announced and its clock is known
  /// The first client-side epoch of this connection; older frames are void.
  std::uint32_t first_epoch = 0;
  Duration clock_offset{0};          ///< media clock - local clock, now
  Duration pipeline_latency{0};      ///< announced by the server
  Duration playout_delay_target{0};  ///< what the jitter of the last seconds asks for
  Duration frame_interval{40'000'000};
  Workspace workspace;
  double largest_acceleration_mm_s2 = 0.0;  ///< 0: unknown
  double author_mass_kg = 0.0;              ///< 0: none given
};

}  // namespace hapticast::client
