// SPDX-License-Identifier: MIT
// Object proposals, for the automatic choice: places where an object may be. A compact component of
// depth is a free-standing object. A component that reaches the picture's border is a limb, perhaps
// with a body. Its geodesic end is the part that is farthest from the border along the component,
// and may hold an object. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Returns the mask (0/255) of the nearest compact component of `labels`, or an empty mask if there
/// is none. A compact component covers 0.6 to 30 % of the picture and at least 35 % of its own
/// bounding box. It is also clear of the picture's border and has enough texture to track.
/// `labels`: see depthComponents().
cv::Mat findNearestCompact(const FrameImages& images, const cv::Mat& labels);

/// A place where an object may be.
struct ObjectProposal {
  cv::Point at;           ///< px of the picture
  double depth_mm = 0.0;  ///< median depth of the region around it
  bool at_limb = false;   ///< the end of a component that reaches the picture's border
};

/// Returns places where an object may be, the nearest ones first, at most six. `labels`: see
/// depthComponents().
std::vector<ObjectProposal> proposeObjects(const FrameContext& scene, const cv::Mat& labels);

}  // namespace hapticast::server
