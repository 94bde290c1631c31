// SPDX-License-Identifier: MIT
// Schemas of the messages in recordings: the FileDescriptorSets that protoc makes of the files in
// proto/. Thread: any.
#pragma once

#include <string>

#include "common/recording/mcap_records.hpp"

namespace hapticast {

/// Returns a channel of protobuf messages of the type `message`: one of hapticast.proto, such as
/// "hapticast.proto.HapticFrame", or of foxglove ("foxglove.CompressedImage"). `is_state`: see
/// McapChannel.
[[nodiscard]] McapChannel makeChannel(const std::string& topic, const std::string& message,
                                      bool is_state = false);

}  // namespace hapticast
