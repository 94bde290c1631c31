// SPDX-License-Identifier: MIT
// Drives a segmenter frame by frame, for its tests.
#pragma once

#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/segment/make_segmenter.hpp"

namespace hapticast::server::test {

/// Intersection over union.
inline double overlap(const cv::Mat& a, const cv::Mat& b) {
  return double(cv::countNonZero(a & b)) / std::max(1, cv::countNonZero(a | b));
}

/// Images of a frame without masks.
inline FrameImages imagesWith(const cv::Mat& color, const cv::Mat& depth) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return {color, gray, depth, {}, {}};
}

struct Runner {
  SourceInfo info;
  std::unique_ptr<Segmenter> segmenter;
  std::optional<FramePairs> frames;
  std::vector<Segment> segments;

  /// `measured`: the motion of every object in place of the measured one.
  const std::vector<Segment>& next(const RgbdFrame& frame,
                                   const std::optional<ObjectFlow>& measured = {}) {
    if (!frames) frames.emplace(info, true);
    const FramePair pair = frames->push(frame, 0.0);
    Flows flows;
    for (const Segment& s : segments) {
      if (!pair.last.gray.empty())
        flows[s.id] =
            measured ? *measured : trackObject(pair.last.gray, pair.now.gray, s.mask, {0, 0});
    }
    segments = segmenter->next(pair, flows);
    return segments;
  }
};

}  // namespace hapticast::server::test
