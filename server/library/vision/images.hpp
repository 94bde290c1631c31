// SPDX-License-Identifier: MIT
// Converts images and the properties of their source between the library (hapticast/vision.hpp) and
// the programs, and checks them. Public images have RGB, those of the programs BGR. Thread: any.
#pragma once

#include "server/include/hapticast/vision.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast {

/// Returns the properties that `info` states.
[[nodiscard]] SourceInfo exportSourceInfo(const server::SourceInfo& info);
/// Returns the properties that `info` states, of a live source: images of a user pass once. Throws
/// std::invalid_argument if a value is outside its range.
[[nodiscard]] server::SourceInfo importSourceInfo(const SourceInfo& info);

/// Returns a copy of `frame` with the time `time_s`. Depths that are not finite become 0.
[[nodiscard]] Images exportImages(const server::RgbdFrame& frame, double time_s);
/// Returns a copy of the images of `images`. An absent picture becomes a black one. Requires images
/// that passed checkImages().
[[nodiscard]] server::RgbdFrame importImages(const Images& images);
/// Throws std::invalid_argument unless `images` has the sizes of `info` and depths in their range.
void checkImages(const Images& images, const server::SourceInfo& info);

}  // namespace hapticast
