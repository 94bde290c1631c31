// SPDX-License-Identifier: MIT
// Limits of the sizes of pictures. Thread: any.
#pragma once

#include <cstdint>
#include <string>

namespace hapticast::server {

/// Returns a size as text, for example "640x480".
[[nodiscard]] std::string sizeText(int width_px, int height_px);

// Largest pictures that a source reads; it scales them down. Chosen: 8K.
inline constexpr int kMostSide_px = 8192;
inline constexpr std::int64_t kMostPixels = std::int64_t{8192} * 4320;

/// Returns whether a source reads pictures of this size: 1 to kMostSide_px px a side, and at most
/// kMostPixels in all.
[[nodiscard]] bool sizeReadable(std::int64_t width_px, std::int64_t height_px);

/// Returns the problem of a picture that is too large to be read, as a phrase.
[[nodiscard]] std::string describeTooLarge(std::int64_t width_px, std::int64_t height_px);

/// Returns whether a stream may have this size (1x1 .. kMaxWidth_px x kMaxHeight_px of
/// common/haptic_frame.hpp).
[[nodiscard]] bool sizeAllowed(int width_px, int height_px);

}  // namespace hapticast::server
