// SPDX-License-Identifier: MIT
// Video object segmentation: assigns pixels to objects, frame by frame. One interface, with one
// implementation for each method.
// The methods are the source's own masks (segmenter.cpp), the thesis's edge fusion (edges.cpp), and
// narrow-band tracking after an initial mask (follow/narrow_band_tracker.hpp). Thread: the one that
// runs Vision.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Pixels of one object in one frame.
struct Segment {
  std::uint32_t id = 0;  ///< an object that was lost and found again has a new id
  cv::Mat mask;          ///< CV_8UC1, 0/255, image size; read-only
  double quality = 1.0;  ///< 1: decided in this frame; less: only propagated
};

/// Segmentation of one clip.
class Segmenter {
 public:
  virtual ~Segmenter() = default;
  /// Returns the objects present in this frame. The list has no lost objects, and after a cut no
  /// object of the old scene. `flows`: motion of the last frame's objects.
  /// Throws SourceError if an object point lies on no object.
  virtual std::vector<Segment> next(const FramePair& frames, const Flows& flows) = 0;
  /// Returns whether an annotation changes this frame, so that it must be processed even if all
  /// objects rest. Call before next().
  [[nodiscard]] virtual bool hasAnnotation(const FramePair& /*frames*/) const { return false; }
};

/// Size below which an object is lost, px. Chosen: 1.5 mm across in a usual picture.
inline constexpr int kSmallestObject_px = 40;

/// Creates the segmenter for `settings`. `has_mask`: the source has masks. The segmenter increments
/// `next_id`. `next_id` and `annotations` (of a recorded clip, else null) must outlive it.
std::unique_ptr<Segmenter> makeSegmenter(const VisionSettings& settings, bool has_mask,
                                         std::uint32_t& next_id,
                                         ClipAnnotations* annotations = nullptr);
/// Creates the thesis's segmenter. `next_id` must outlive it.
std::unique_ptr<Segmenter> makeEdgeSegmenter(const VisionSettings& settings,
                                             std::uint32_t& next_id);

/// Throws the SourceError of an object point without an object. `why`: the cause, as text.
[[noreturn]] void throwNoObject(const Vec2& point_px, const std::string& why);

}  // namespace hapticast::server
