// SPDX-License-Identifier: MIT
// Converts a tracked object to its descriptors (HapticObject), one for each layer, with reliefs in
// nominal mm. An unchanged relief is the same object in memory as that of the frame before. Thread:
// the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/motion/object_pose.hpp"
#include "server/vision/surface/layer_cutter.hpp"
#include "server/vision/track.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns the descriptor of the one surface of `object`. The motion is missing; FrameMotion adds
/// it. If the relief did not change, the result has the pointer and the changed_in_frame of `last`.
/// `last`: the descriptor of the same object in the frame before, or null. `clock`: measures the
/// duration of the smoothing; null: no measurement. Adds its measurements to `report`.
HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings, const Clock* clock,
                            StageReport& report);

/// Descriptors of an object's layers, and the measurements of the stages for its scene plan.
struct Described {
  std::vector<HapticObject> layers;
  StageReport report;
  std::vector<std::shared_ptr<const Relief>> measured;  ///< as VisionResult::measured
};
/// Returns one descriptor for each layer of `object`. Depth steps separate the layers. With the
/// thesis's method there is one layer only. `last`: the descriptors of all objects in the frame
/// before. An object that is entirely at rest or lost has the same layers as in `last`.
Described describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                         const std::vector<HapticObject>& last, const DepthNoise& noise,
                         const NominalFrame& nominal, const VisionSettings& settings,
                         const Clock* clock, LayerCutter& cutter);

/// Encodes `color` (CV_8UC3, BGR) as a JPEG. `quality` is clamped to 1..100. Returns an empty
/// vector if `color` is empty or cannot be encoded. The viewer's window shows the picture. Thread:
/// any.
std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality);

}  // namespace hapticast::server
