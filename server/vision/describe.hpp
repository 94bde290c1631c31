// SPDX-License-Identifier: MIT
// From a tracked object to its place in the descriptor: a relief in nominal mm, and what of it did
// not change. Thread: vision's.
#pragma once

#include <cstdint>
#include <vector>

#include "server/vision/motion/nominal_frame.hpp"
#include "server/vision/surface/layer_cutter.hpp"
#include "server/vision/tracked_object.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// The object as it enters the descriptor; its motion comes later, with the window. `last`: the
/// same object in the frame before, or null; an unchanged relief keeps its pointer and its
/// changed_in_frame. `clock` tells the plan how long smoothing takes; null: nobody asks.
HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings, const Clock* clock);

/// The same cut into layers where its depth steps; not in the thesis's method. `last`: all objects
/// of the frame before. What is entirely at rest or lost is taken from there.
std::vector<HapticObject> describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                                         const std::vector<HapticObject>& last,
                                         const DepthNoise& noise, const NominalFrame& nominal,
                                         const VisionSettings& settings, const Clock* clock,
                                         LayerCutter& cutter);

}  // namespace hapticast::server
