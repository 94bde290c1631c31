// SPDX-License-Identifier: MIT
// Results of a clip's scan that each playback uses: the initial state, and masks that later
// annotations imply for earlier frames (backward propagation).
// Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"

namespace hapticast::server {

/// Colours of the author's negative points (--not), which separate objects from them.
struct NegativeColors {
  ColorHistogram histogram;
  cv::Mat samples;  ///< CV_32FC3, Lab (L 0..100), one column; empty: no negative points
};

/// Mask of an object in a frame, from an annotation of this frame or of a later frame.
struct PropagatedMask {
  int number = 0;      ///< number of the object; see TrackedMask::number()
  cv::Rect box;        ///< of the picture; empty: not visible
  cv::Mat mask;        ///< CV_8UC1, 0/255, over the box
  bool given = false;  ///< the author's key mask of this frame
};

struct InitialState;  // follow/narrow_band_tracker.hpp

/// Annotations of a clip, in a form that its playbacks share.
struct ClipAnnotations {
  /// Initial state; its computation costs as much as ten frames. Null before.
  std::shared_ptr<const InitialState> start;
  NegativeColors avoided;                                      ///< of the author's negative points
  std::map<std::uint64_t, std::vector<PropagatedMask>> masks;  ///< by frame of the clip
  /// True during a scan; then annotations of later frames propagate backward.
  bool open = false;
};

}  // namespace hapticast::server
