// SPDX-License-Identifier: MIT
// Factory of the segmenters. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <memory>

#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns the segmenter for the method of `settings`. `has_mask`: whether the source has masks.
/// The segmenter increments `next_id` for each new object. `annotations` are those of a recorded
/// clip; null for a live source. `next_id` and `annotations` must outlive the segmenter.
std::unique_ptr<Segmenter> makeSegmenter(const VisionSettings& settings, bool has_mask,
                                         std::uint32_t& next_id,
                                         ClipAnnotations* annotations = nullptr);
/// Returns the segmenter of the thesis's method (edge fusion). `next_id` must outlive it.
std::unique_ptr<Segmenter> makeEdgeSegmenter(const VisionSettings& settings,
                                             std::uint32_t& next_id);

}  // namespace hapticast::server
