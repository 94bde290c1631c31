// SPDX-License-Identifier: MIT
// Drops frames that are stale when they leave, for example the backlog of a server or an edge that
// stood still. A frame is stale if its age exceeds the usual age by kStaleAge; after a stale frame
// two intervals are enough. The usual age is that of the last frame that left in time. While the
// age falls from frame to frame, the frames are a backlog, and only the newest one is held. An age
// that has not fallen for kSettle is the new usual age, so a server that is always late keeps its
// stream. A held frame leaves late if no other one follows for two intervals. Times are arguments.
// Thread: one (the network's).
#pragma once

#include <cstdint>
#include <optional>

#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Filter of the frames of one stream.
class StaleFrameFilter {
 public:
  /// Time without a fall of the age after which it is the usual one. Chosen: a backlog that falls
  /// by kFall in this time takes minutes to end.
  static constexpr Duration kSettle = std::chrono::seconds(1);
  /// Least fall of the age that counts; chosen: more than the jitter of a network thread.
  static constexpr Duration kFall = std::chrono::milliseconds(5);

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
  /// A time with stale frames.
  struct Backlog {
    Duration least_age;
    MediaTime fell_at;  // when the age last fell
  };
  std::optional<EncodedFrame> held_;
  MediaTime release_at_;
  std::optional<Backlog> backlog_;
  Duration usual_age_{0};
  std::uint64_t dropped_ = 0;
};

}  // namespace hapticast::server
