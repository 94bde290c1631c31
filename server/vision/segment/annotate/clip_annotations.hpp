// SPDX-License-Identifier: MIT
// What is learnt of a recorded clip when it is looked through, and used whenever it is played:
// its start, and what the author's words in later frames teach about the frames before them.
// Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"

namespace hapticast::server {

/// Colours of what the author does not mean (--not), by which every object is told from it.
struct NegativeColors {
  ColorHistogram histogram;
  cv::Mat samples;  ///< CV_32FC3, Lab (L 0..100), one column; empty: nothing was said
};

/// Where an object is in a frame by the author's word, or by one in a later frame.
struct PropagatedMask {
  int number = 0;      ///< of the object; see TrackedMask::number()
  cv::Rect box;        ///< of the picture; empty: it is not seen
  cv::Mat mask;        ///< CV_8UC1, 0 / 255, over the box
  bool given = false;  ///< drawn by the author for this very frame
};

struct InitialState;  // band.hpp

struct ClipAnnotations {
  /// The careful start, which costs as much as ten frames; null until there is one.
  std::shared_ptr<const InitialState> start;
  NegativeColors avoided;
  std::map<std::uint64_t, std::vector<PropagatedMask>> masks;  ///< by frame of the clip
  /// While the clip is looked through; words of later frames are then carried back.
  bool open = false;
};

}  // namespace hapticast::server
