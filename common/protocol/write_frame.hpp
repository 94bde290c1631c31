// SPDX-License-Identifier: MIT
// Encoder of frames to protobuf messages, whole or in fragments; part of encode() and packFrame().
// Thread: any.
#pragma once

#include <cstddef>

#include "common/codec/coded_frame.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Writes a whole frame.
void writeFrame(const CodedFrame& from, proto::HapticFrame& to);
/// Writes an object without its relief and grid.
void writeHead(const CodedObject& from, proto::Object& to);
void writeRect(const PixelRect& from, proto::Relief& to);
/// Appends the cells of the grid from `first` on, at most `most` of them.
void writeCells(const MotionGrid& from, std::size_t first, std::size_t most, proto::MotionGrid& to);

}  // namespace hapticast
