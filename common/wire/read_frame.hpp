// SPDX-License-Identifier: MIT
// Protobuf's frames -> domain structs, with every number checked; part of decode(). Thread: any.
#pragma once

#include <cstdint>
#include <span>

#include "common/wire/check.hpp"
#include "common/wire/coded_frame.hpp"
#include "hapticast.pb.h"

namespace hapticast {

/// Counts what may repeat in the bytes of a message before the parser allocates it.
void boundCounts(std::span<const std::uint8_t> message, Check& check);

/// What it returns means nothing once the check has an error.
[[nodiscard]] CodedFrame readFrame(const proto::HapticFrame& from, Check& check);

}  // namespace hapticast
