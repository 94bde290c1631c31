// SPDX-License-Identifier: MIT
// Bounded queue between the network thread and the decode thread. If frames arrive faster than the
// decoding, the newest ones win: the queue drops the oldest frame but stores its reliefs. Later
// frames may declare those reliefs unchanged.
// Thread: one at a time; DecodeThread locks it.
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
  /// As many as the loop can hold, so that the burst after a stall of the network is played.
  static constexpr std::size_t kMaxFrames = FramePool::kSlots;
  /// Limit of the bytes of all queued slices, and of all stored slices. Chosen: a server occupies
  /// at most 2 x 64 MB here.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// A frame, and the reliefs of the frames that were dropped before it.
  struct Accepted {
    AssembledFrame assembled;
    std::vector<CodedObject> left_out;  ///< oldest first
  };

  /// Appends a frame. Returns the number of older frames that were dropped for it.
  std::size_t push(AssembledFrame assembled);
  /// Removes and returns the oldest frame; nullopt if the queue is empty.
  [[nodiscard]] std::optional<Accepted> pop();
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  void clear();

 private:
  void dropOldest();
  void push(CodedObject object);

  std::deque<AssembledFrame> frames_;  // oldest first
  std::size_t bytes_ = 0;              // bytes of the queued reliefs
  std::vector<CodedObject> kept_;      // of dropped frames, one per object and layer
};

}  // namespace hapticast::client
