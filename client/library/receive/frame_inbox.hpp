// SPDX-License-Identifier: MIT
// Bounded queue between the network thread of a Stream and its reader. A frame waits for its
// picture, if the stream has pictures (picture_pairs.hpp).
// Thread: any; the queue locks itself.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "client/library/receive/picture_pairs.hpp"

namespace hapticast::client {

class FrameInbox {
 public:
  /// The queue drops its oldest frame when it has more than `max_waiting`.
  FrameInbox(std::size_t max_waiting, bool pictures)
      : max_waiting_(max_waiting), pairs_(pictures) {}

  /// Adds a frame, or a picture.
  template <class Item>
  void push(Item item) {
    const std::lock_guard lock(mutex_);
    pairs_.add(std::move(item));
    release();
  }
  /// Ends the queue. `error` is one line, or empty for an end without an error.
  void end(const std::string& error);

  /// Returns the next frame. Waits for it at most `timeout_s` (negative: without a limit). Returns
  /// nullopt after the timeout or the end. Throws std::runtime_error after an end with an error.
  [[nodiscard]] std::optional<Frame> pop(double timeout_s);
  [[nodiscard]] std::uint64_t dropped() const;
  [[nodiscard]] bool ended() const;

 private:
  /// Moves the frames that wait for no picture to the reader's queue.
  void release();

  const std::size_t max_waiting_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  PicturePairs pairs_;         // guarded by mutex_
  std::deque<Frame> frames_;   // guarded by mutex_
  std::uint64_t dropped_ = 0;  // guarded by mutex_
  bool ended_ = false;         // guarded by mutex_
  std::string error_;          // guarded by mutex_
};

}  // namespace hapticast::client
