// SPDX-License-Identifier: MIT
// Drops frames that are stale when they leave, for example the backlog of a server or an edge that
// stood still. A frame is stale if its age exceeds the usual age by kStaleAge. The usual age is
// that of the last frame that left, so a server that is always late keeps its stream. The filter
// holds a stale frame for two frame intervals. If a newer frame arrives meanwhile, the filter drops
// the held one. Otherwise the held frame leaves late. Times are arguments. Thread: one (the
// network's).
#pragma once

#include <cstdint>
#include <optional>

#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Filter of the frames of one stream.
class StaleFrameFilter {
 public:
  /// Adds a frame. Returns the frame to send now, or nullopt if the filter holds `frame`. `now`:
  /// present media time. `latency`: age of a frame that is in time. `interval`: frame interval.
  [[nodiscard]] std::optional<EncodedFrame> push(EncodedFrame frame, MediaTime now,
                                                 Duration latency, Duration interval);
  /// Returns the held frame if it has waited long enough. Call it often.
  [[nodiscard]] std::optional<EncodedFrame> poll(MediaTime now);
  /// Removes the held frame, because another stream begins.
  void reset();

  /// Returns the number of frames that were dropped since the filter's creation.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  std::optional<EncodedFrame> held_;
  MediaTime release_at_;
  Duration usual_age_{0};
  std::uint64_t dropped_ = 0;
};

}  // namespace hapticast::server
