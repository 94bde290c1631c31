// SPDX-License-Identifier: MIT
// Protobuf's frames -> domain structs, with every number checked; part of decode() and readPiece().
// Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/check.hpp"
#include "common/protocol/fragment.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Counts what may repeat in the bytes of a message before the parser allocates it.
void boundCounts(std::span<const std::uint8_t> message, Check& check);
/// The same in those of a frame or a piece of one.
void boundCountsOfFrame(std::span<const std::uint8_t> frame, Check& check);

/// What these return means nothing once the check has an error.
[[nodiscard]] CodedFrame readFrame(const proto::HapticFrame& from, Check& check);
[[nodiscard]] FramePiece readFramePiece(const proto::HapticFrame& from, std::uint64_t frame_id,
                                        Check& check);

/// What objects, and parts of them, owe each other: each of them comes once, slices do not overlap,
/// a grid covers its relief, and all of it is bounded.
void checkFrame(const CodedFrame& frame, Check& check);

}  // namespace hapticast
