// SPDX-License-Identifier: MIT
#include "client/net/frame_assembler.hpp"

#include <utility>

namespace hapticast::client {

void FrameAssembler::restart() {
  ++epoch_;
  server_epoch_.reset();
  last_id_.reset();
}

std::optional<AssembledFrame> FrameAssembler::add(CodedFrame frame) {
  const bool behind = last_id_ && frame.id <= *last_id_;
  const std::uint64_t jump = !last_id_ ? 0 : behind ? *last_id_ - frame.id : frame.id - *last_id_;
  const bool resync = jump > kLargestJump;
  if (behind && !resync) return std::nullopt;
  // The first frame after restart() belongs to the epoch that was announced to the loop.
  if (resync || (server_epoch_ && *server_epoch_ != frame.epoch)) ++epoch_;
  server_epoch_ = frame.epoch;
  FramePlace place{epoch_, !last_id_, resync, 0, frame.media_time, {}};
  if (last_id_ && !resync) {
    place.lost = frame.id - *last_id_ - 1;
    place.gap = frame.media_time - last_media_time_;
  }
  last_id_ = frame.id;
  last_media_time_ = frame.media_time;
  return AssembledFrame{place, std::move(frame)};
}

}  // namespace hapticast::client
