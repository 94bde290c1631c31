// SPDX-License-Identifier: MIT
// Results of a clip's scan that every playback uses: the initial state of the segmentation, and
// masks of the frames before an annotation. The scan propagates these masks backwards from the
// annotation. Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"

namespace hapticast::server {

/// Colours around the author's negative points (--not). Pixels of these colours probably do not
/// belong to the object.
struct NegativeColors {
  ColorHistogram histogram;
  cv::Mat samples;  ///< CV_32FC3, Lab (L 0..100), one column; empty: no negative points
};

/// Mask of an object in one frame, computed from an annotation of this frame or of a later frame.
struct PropagatedMask {
  int number = 0;      ///< number of the object; see TrackedMask::number()
  cv::Rect box;        ///< part of the picture, px; empty: the object is not visible
  cv::Mat mask;        ///< CV_8UC1, 0/255, over the box
  bool given = false;  ///< true: the mask is the author's key mask of this frame
};

struct InitialState;  // follow/narrow_band_tracker.hpp

/// Results of the author's annotations of a clip, which all its playbacks share.
struct ClipAnnotations {
  /// Initial state of the clip's segmentation; null until it has been computed. The computation
  /// costs as much time as ten frames.
  std::shared_ptr<const InitialState> start;
  NegativeColors avoided;  ///< colours of the author's negative points
  /// Masks by index of the frame in the clip.
  std::map<std::uint64_t, std::vector<PropagatedMask>> masks;
  /// True during a scan. Only then are annotations of later frames propagated backwards.
  bool open = false;
};

}  // namespace hapticast::server
