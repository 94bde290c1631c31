// SPDX-License-Identifier: MIT
// Converts a tracked object to its descriptor: reliefs in nominal mm for each layer, with an
// unchanged relief shared with the frame before. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/motion/object_pose.hpp"
#include "server/vision/surface/layers.hpp"
#include "server/vision/track.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns the descriptor of `object` without its motion, which FrameMotion adds. `last`: the same
/// object in the frame before, or null.
/// The pointer and the changed_in_frame of an unchanged relief stay. `clock` measures the duration
/// of smoothing for the plan; null: no measurement.
HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings, const Clock* clock);

/// Returns the descriptors of all layers of `object`. Depth steps separate the layers; the thesis's
/// method has one layer. `last`: all objects of the frame before. An object entirely at rest or
/// lost reuses its layers of `last`.
std::vector<HapticObject> describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                                         const std::vector<HapticObject>& last,
                                         const DepthNoise& noise, const NominalFrame& nominal,
                                         const VisionSettings& settings, const Clock* clock,
                                         LayerCutter& cutter);

// JPEG encoding of the picture for the viewer's window. Thread: any.

/// Encodes `color` (CV_8UC3, BGR) as a JPEG. `quality` is clamped to 1..100. Returns an empty
/// vector if `color` is empty or cannot be encoded.
std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality);

}  // namespace hapticast::server
