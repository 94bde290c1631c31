// SPDX-License-Identifier: MIT
// Frames -> protobuf's, whole or in pieces; part of encode() and of packFrame(). Thread: any.
#pragma once

#include <cstddef>

#include "common/codec/coded_frame.hpp"
#include "hapticast.pb.h"

namespace hapticast {

void writeFrame(const CodedFrame& from, proto::HapticFrame& to);
/// What of an object is no relief and no grid.
void writeHead(const CodedObject& from, proto::Object& to);
void writeRect(const PixelRect& from, proto::Relief& to);
/// Cells of the grid from `first` on, at most `most` of them, behind those that stand there.
void writeCells(const MotionGrid& from, std::size_t first, std::size_t most, proto::MotionGrid& to);

}  // namespace hapticast
