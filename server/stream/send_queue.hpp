// SPDX-License-Identifier: MIT
// What waits to be sent to one viewer: newest wins, age and size bounded, so that a slow viewer
// costs nothing. Pure: no sockets, no clocks. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Counted over the life of a queue.
struct SendCounts {
  std::uint64_t frames_sent = 0;
  std::uint64_t videos_sent = 0;
  std::uint64_t frames_dropped_full = 0;  ///< newer ones came while kMaxFrames waited
  std::uint64_t frames_dropped_old = 0;   ///< more than kMaxAge behind the newest
  std::uint64_t videos_dropped = 0;       ///< a newer one came

  SendCounts& operator+=(const SendCounts& other);
  [[nodiscard]] std::uint64_t dropped() const {
    return frames_dropped_full + frames_dropped_old + videos_dropped;
  }
};

class SendQueue {
 public:
  static constexpr std::size_t kMaxFrames = 3;
  static constexpr Duration kMaxAge = std::chrono::milliseconds(250);
  static constexpr std::size_t kMaxControl = 64;

  /// False when kMaxControl messages wait already: the peer asks without reading the answers.
  [[nodiscard]] bool pushControl(SharedBytes payload);
  /// Replaces a description that still waits.
  void pushDescription(SharedBytes payload) { description_ = std::move(payload); }
  void pushFrame(EncodedFrame frame);
  void pushVideo(EncodedVideo video);
  /// Forgets frames and videos: they belong to another picture, as do the reliefs that the viewer
  /// has; the next frame is a whole one.
  void clearFrames();
  /// Forgets everything: the session ends.
  void clear();

  /// Whether a control message is what pop() gives next.
  [[nodiscard]] bool controlWaits() const { return !control_.empty(); }
  /// Gives back at once what pushFrame() and pop() would. Requires that nothing waits.
  [[nodiscard]] SharedBytes pass(const EncodedFrame& frame);
  /// What to send next (control, then frames, then video), null when nothing waits.
  [[nodiscard]] SharedBytes pop();

  [[nodiscard]] const SendCounts& counts() const { return counts_; }

 private:
  void dropOldest(std::uint64_t& cause);

  // What pass() touches comes first, in one line of the processor's cache.
  SendCounts counts_;
  bool needs_key_frame_ = true;  // joined, or lost a frame since the last one sent
  std::deque<SharedBytes> control_;
  SharedBytes description_;
  std::deque<EncodedFrame> frames_;
  std::optional<EncodedVideo> video_;
};

}  // namespace hapticast::server
