// SPDX-License-Identifier: MIT
// Bounded queue between the network thread of a Stream and its reader. A frame waits for its
// picture, if the stream has pictures.
// Thread: any; the queue locks itself.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/include/hapticast/frame.hpp"

namespace hapticast::client {

class FrameInbox {
 public:
  /// The queue drops its oldest frame when it has more than `max_waiting`.
  FrameInbox(std::size_t max_waiting, bool pictures)
      : max_waiting_(max_waiting), pictures_(pictures) {}

  void push(Frame frame);
  /// Adds the picture of frame `id`. The frames before it have none.
  void push(std::uint64_t id, std::vector<std::uint8_t> jpeg);
  /// Ends the queue. `error` is one line, or empty for an end without an error.
  void end(const std::string& error);

  /// Returns the next frame. Waits for it at most `timeout_s` (negative: without a limit). Returns
  /// nullopt after the timeout or the end. Throws std::runtime_error after an end with an error.
  [[nodiscard]] std::optional<Frame> pop(double timeout_s);
  [[nodiscard]] std::uint64_t dropped() const;
  [[nodiscard]] bool ended() const;

 private:
  /// Moves the first `count` frames that wait for pictures to the reader's queue.
  void release(std::size_t count);

  const std::size_t max_waiting_;
  const bool pictures_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Frame> without_picture_;  // guarded by mutex_
  std::deque<Frame> frames_;           // guarded by mutex_
  std::uint64_t dropped_ = 0;          // guarded by mutex_
  bool ended_ = false;                 // guarded by mutex_
  std::string error_;                  // guarded by mutex_
};

}  // namespace hapticast::client
