// SPDX-License-Identifier: MIT
// Which pixels belong to which object, frame by frame. One interface and a file per kind: the
// source's own masks (segment.cpp), the thesis's edge fusion (edges), the careful start and carried
// band (band). Thread: the one that runs Vision.
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

struct Segment {
  std::uint32_t id = 0;  ///< a re-found object has a new one
  cv::Mat mask;          ///< CV_8UC1, 0 / 255, size of the picture; nobody writes into it
  double quality = 1.0;  ///< 1: decided from this frame; less: carried on
};

class Segmenter {
 public:
  virtual ~Segmenter() = default;
  /// The objects present in this frame; one that is lost is not in the list, and at a cut all are.
  /// `flows`: how the objects of the last frame moved. Throws SourceError where an object point
  /// names nothing.
  virtual std::vector<Segment> next(const FramePair& frames, const Flows& flows) = 0;
  /// Whether the author's word changes something in this frame, so that it is to be looked at even
  /// where everything rests. Before next().
  [[nodiscard]] virtual bool hasAnnotation(const FramePair& /*frames*/) const { return false; }
};

/// Below this many pixels an object is lost; chosen, in a usual picture 1.5 mm across.
inline constexpr int kSmallestObject_px = 40;

/// Which segmenter `settings` ask for, given whether the source brings masks. `next_id` is counted
/// up; it and `lessons` (of a recorded clip, else null) must outlive the segmenter.
std::unique_ptr<Segmenter> makeSegmenter(const VisionSettings& settings, bool has_mask,
                                         std::uint32_t& next_id,
                                         ClipAnnotations* annotations = nullptr);
std::unique_ptr<Segmenter> makeEdgeSegmenter(const VisionSettings& settings,
                                             std::uint32_t& next_id);

/// Throws the SourceError of an object point with nothing under it; `why` says what is there
/// instead.
[[noreturn]] void throwNoObject(const Vec2& point_px, const std::string& why);

}  // namespace hapticast::server
