// SPDX-License-Identifier: MIT
// Encoder of frames: writes the structs of haptic_frame.hpp to protobuf messages. encode() uses it
// for whole frames, and packFrame() for the fragments of a frame.
// Thread: any.
#pragma once

#include <cstddef>

#include "common/codec/coded_frame.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Writes all objects of the frame `from` to `to`.
void writeFrame(const CodedFrame& from, proto::HapticFrame& to);
/// Writes the object `from` to `to`, without its relief and its motion grid.
void writeHead(const CodedObject& from, proto::Object& to);
void writeMaterial(const Material& from, proto::Material& to);
void writeRect(const PixelRect& from, proto::Relief& to);
/// Appends cells of the grid `from` to `to`. It begins with the cell `first` and appends at most
/// `most` cells.
void writeCells(const MotionGrid& from, std::size_t first, std::size_t most, proto::MotionGrid& to);

}  // namespace hapticast
