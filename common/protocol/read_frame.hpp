// SPDX-License-Identifier: MIT
// Decoder of frames: converts protobuf messages to the structs of haptic_frame.hpp, and checks
// every number. decode() and readPiece() call it. Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "common/codec/coded_frame.hpp"
#include "common/protocol/check.hpp"
#include "common/protocol/fragment.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Counts the entries of repeated fields in the bytes of a message, before the parser allocates
/// memory for them. Records an error in `check` if there are too many.
void boundCounts(std::span<const std::uint8_t> message, Check& check);
/// Counts the entries of repeated fields in the bytes of a frame or of a fragment.
void boundCountsOfFrame(std::span<const std::uint8_t> frame, Check& check);

/// As boundCounts(), for a message whose frame is in the field number `field`. Two frames in it are
/// an error, too.
void boundCountsOfContent(std::span<const std::uint8_t> message, std::uint32_t field, Check& check);

/// Return the struct of a parsed frame or fragment. They record an error in `check` for every
/// invalid value. After an error the returned values are undefined.
[[nodiscard]] CodedFrame readFrame(const proto::HapticFrame& from, Check& check);
[[nodiscard]] FramePiece readFramePiece(const proto::HapticFrame& from, std::uint64_t frame_id,
                                        Check& check);

/// Returns the struct of a frame whose reliefs may lack slices, as a client assembled it.
[[nodiscard]] CodedFrame readAssembledFrame(const proto::HapticFrame& from, Check& check);

/// Returns the struct of a parsed material. Records an error in `check` for every invalid value.
[[nodiscard]] Material readMaterial(const proto::Material& from, Check& check);

/// Checks that the objects of a frame are consistent, and records an error in `check` if they are
/// not. No object may occur twice, and no slices may overlap. A grid must cover its relief, and the
/// limits of the whole frame must hold.
void checkFrame(const CodedFrame& frame, Check& check);

}  // namespace hapticast
