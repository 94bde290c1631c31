// SPDX-License-Identifier: MIT
// Send queue of one viewer with head drop: newest frames win, age and size are bounded, so that a
// slow viewer costs nothing. No sockets, no clocks. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Counts over the life of a queue.
struct SendCounts {
  std::uint64_t frames_sent = 0;
  std::uint64_t videos_sent = 0;
  std::uint64_t frames_dropped_full = 0;  ///< newer frames arrived while kMaxFrames waited
  std::uint64_t frames_dropped_old = 0;   ///< more than kMaxAge behind the newest
  std::uint64_t videos_dropped = 0;       ///< a newer picture arrived

  SendCounts& operator+=(const SendCounts& other);
  [[nodiscard]] std::uint64_t dropped() const {
    return frames_dropped_full + frames_dropped_old + videos_dropped;
  }
};

/// Items that wait for one viewer.
class SendQueue {
 public:
  static constexpr std::size_t kMaxFrames = 3;  ///< frames in the queue
  /// Behind the newest frame, in media time.
  static constexpr Duration kMaxAge = std::chrono::milliseconds(250);
  static constexpr std::size_t kMaxControl = 64;  ///< control messages in the queue

  /// Adds a control message. Returns false if kMaxControl messages wait: the peer requests without
  /// reading the answers.
  [[nodiscard]] bool pushControl(SharedBytes payload);
  /// Sets the description; replaces one that still waits.
  void pushDescription(SharedBytes payload) { description_ = std::move(payload); }
  /// Adds a frame and drops frames beyond kMaxFrames or kMaxAge. After a drop the next sent frame
  /// is a key frame.
  void pushFrame(EncodedFrame frame);
  /// Sets the picture; replaces one that still waits.
  void pushVideo(EncodedVideo video);
  /// Removes frames and pictures, which belong to another workspace. The next frame is a key frame.
  void clearFrames();
  /// Removes all items, at the end of a session.
  void clear();

  /// Returns whether pop() would return a control message.
  [[nodiscard]] bool controlWaits() const { return !control_.empty(); }
  /// Returns the payload that pushFrame() and pop() would return. Requires an empty queue.
  [[nodiscard]] SharedBytes pass(const EncodedFrame& frame);
  /// Returns the next payload (control, description, frames, then video); null if the queue is
  /// empty.
  [[nodiscard]] SharedBytes pop();

  [[nodiscard]] const SendCounts& counts() const { return counts_; }

 private:
  void dropOldest(std::uint64_t& cause);

  // Members of pass() first, in one cache line.
  SendCounts counts_;
  bool needs_key_frame_ = true;  // after joining or a dropped frame
  std::deque<SharedBytes> control_;
  SharedBytes description_;
  std::deque<EncodedFrame> frames_;
  std::optional<EncodedVideo> video_;
};

}  // namespace hapticast::server
