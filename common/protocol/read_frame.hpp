// SPDX-License-Identifier: MIT
// Decoder of frames: protobuf messages to domain structs, with every number checked; part of
// decode() and readPiece(). Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/check.hpp"
#include "common/protocol/fragment.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Bounds the repeated fields in a message's bytes before the parser allocates memory for them.
void boundCounts(std::span<const std::uint8_t> message, Check& check);
/// Bounds the repeated fields of a frame or a fragment.
void boundCountsOfFrame(std::span<const std::uint8_t> frame, Check& check);

/// Return undefined values after an error of the check.
[[nodiscard]] CodedFrame readFrame(const proto::HapticFrame& from, Check& check);
[[nodiscard]] FramePiece readFramePiece(const proto::HapticFrame& from, std::uint64_t frame_id,
                                        Check& check);

/// Checks the consistency of objects and fragments: no object twice, no overlap of slices, a grid
/// that covers its relief, limits of the whole frame.
void checkFrame(const CodedFrame& frame, Check& check);

}  // namespace hapticast
