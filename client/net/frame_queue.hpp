// SPDX-License-Identifier: MIT
// The frames that wait for their preparation, bounded. When frames come faster than they can be
// prepared the newest win: the oldest one is left out, but its reliefs stay until the next frame is
// taken, because that one and later ones may say "unchanged" of them. Thread: one at a time; the
// preparer locks it.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/relief_cache.hpp"

namespace hapticast::client {

class FrameQueue {
 public:
  /// As many as the loop can hold: the burst that follows a stall of the network is played.
  static constexpr std::size_t kMaxFrames = FramePool::kSlots;
  /// Chosen: all slices that wait, and all that are kept, so that a server cannot make a viewer
  /// hold more than 2 x 64 MB here.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// A frame, and the objects with the reliefs of the frames that were left out before it.
  struct Accepted {
    AssembledFrame assembled;
    std::vector<CodedObject> left_out;  ///< oldest first
  };

  /// Appends a frame; returns how many older ones were left out for it.
  std::size_t push(AssembledFrame assembled);
  /// Takes the oldest frame; nullopt when none waits.
  [[nodiscard]] std::optional<Accepted> pop();
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  void clear();

 private:
  void dropOldest();
  void push(CodedObject object);

  std::deque<AssembledFrame> frames_;  // oldest first
  std::size_t bytes_ = 0;              // of their reliefs
  std::vector<CodedObject> kept_;      // of frames left out, one per object and layer
};

}  // namespace hapticast::client
