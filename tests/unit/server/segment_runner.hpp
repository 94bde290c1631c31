// SPDX-License-Identifier: MIT
// Drives a segmenter frame by frame, for its tests.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "server/vision/base/flow.hpp"
#include "server/vision/segment/segment.hpp"

namespace hapticast::server::test {

/// Intersection over union.
inline double overlap(const cv::Mat& a, const cv::Mat& b) {
  return double(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

struct Runner {
  SourceInfo info;
  std::unique_ptr<Segmenter> segmenter;
  View last;
  std::vector<Segment> segments;

  const std::vector<Segment>& next(const RgbdFrame& frame) {
    const View view = makeView(frame, info);
    Flows flows;
    for (const Segment& s : segments)
      flows[s.id] = trackObject(last.gray, view.gray, s.mask, {0, 0});
    segments = segmenter->next(view, flows);
    last = view;
    return segments;
  }
};

}  // namespace hapticast::server::test
