// SPDX-License-Identifier: MIT
// The frame number in the name of an image. Thread: any.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace hapticast::server {

/// Returns the frame number in the name of `image`, its last digits. Returns nullopt if it has
/// none. A time stamp is none: it has a dot, or more than 9 digits.
[[nodiscard]] std::optional<std::uint64_t> frameNumber(const std::filesystem::path& image);

}  // namespace hapticast::server
