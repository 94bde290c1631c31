// SPDX-License-Identifier: MIT
// Finds input that is valid, but probably a mistake: depth without a surface, inverted depth,
// metres in place of millimetres, tiny pictures, a clip without an object. Logs one warning with
// the remedy for each mistake. Thread: the pipeline's.
#pragma once

#include <string>

#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Logs a warning for each unlikely range of `settings` (--map-range, --depth-range), and for each
/// unlikely property of the clip: a tiny picture, one depth value everywhere, inverted 8-bit depth.
/// For the depth it reads the first frames of a recorded clip and rewinds it. Returns false if
/// viewers could touch nothing, because the picture is tiny or its depth has no surface. Throws
/// SourceError.
bool warnOfUnlikelyInput(RgbdSource& source, const VisionSettings& settings);

/// Logs a warning if `vision` has found no object in a scanned clip. `source` is the clip's name.
void warnOfNoObject(const Vision& vision, const std::string& source);

/// Returns the share of the upper border of `depth` that is nearer than the object, 0..1. `depth`
/// is 8-bit depth (DepthKind::kHeight). The upper border is the top edge and the upper halves of
/// the side edges, a twentieth of the picture wide. The depth of the object is the median around
/// the author's points of the first frame. Without such a point it is the median of the picture's
/// middle. In most pictures the upper border shows the background. So it is farther than the
/// object, unless the depth is inverted.
[[nodiscard]] double shareOfNearBorder(const cv::Mat& depth, const VisionSettings& settings);

}  // namespace hapticast::server
