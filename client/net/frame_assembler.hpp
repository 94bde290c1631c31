// SPDX-License-Identifier: MIT
// The first step of receiving: what the transport brings becomes whole frames in their order. TCP
// brings whole frames, so that the rule of ids and epochs is all that is left to apply. Thread:
// network.
#pragma once

#include <cstdint>
#include <optional>

#include "common/wire/coded_frame.hpp"

namespace hapticast::client {

/// Where a frame stands in the stream.
struct FramePlace {
  std::uint32_t epoch = 0;  ///< client-side; unlike the server's it never repeats
  bool first = false;       ///< of its connection
  bool resync = false;      ///< its id is no successor of the last one's: numbering began anew
  std::uint64_t lost = 0;   ///< frames that are missing before it (0 for the first, and a resync)
  MediaTime media_time;
  Duration gap{0};  ///< media time since the frame before (0 for the first, and a resync)
};

/// A whole frame in its place.
struct AssembledFrame {
  FramePlace place;
  CodedFrame frame;
};

class FrameAssembler {
 public:
  /// Chosen: 10 s of the fastest stream. Ids that jump further, forwards or backwards, are not
  /// those of a network that loses or reorders.
  static constexpr std::uint64_t kLargestJump = 2400;

  /// A connection is made: ids start over, and a new epoch begins.
  void restart();
  /// The client-side epoch of the next frame, unless the server begins another one with it.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_; }
  /// Takes a frame as it came; nullopt when it came before or when a later one did (ids rise). One
  /// whose id jumps by more than kLargestJump begins a numbering and an epoch of its own.
  [[nodiscard]] std::optional<AssembledFrame> add(CodedFrame frame);

 private:
  std::uint32_t epoch_ = 0;
  std::optional<std::uint32_t> server_epoch_;  // of the last frame of this connection
  std::optional<std::uint64_t> last_id_;       // of this connection
  MediaTime last_media_time_;                  // of the frame last_id_
};

}  // namespace hapticast::client
