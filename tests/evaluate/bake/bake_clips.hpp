// SPDX-License-Identifier: MIT
// Drawn clips with truth for the topic `bake`: each frame with the exact mask and depth of the
// object. Thread: any; values.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/source/rgbd_source.hpp"

namespace hapticast::evaluate {

/// A clip in memory with its truth.
struct BakeClip {
  struct Truth {
    cv::Mat mask;   ///< 0 / 255
    cv::Mat depth;  ///< CV_32FC1, mm
    /// Of the object's centre, nominal mm/s²; nullopt: not known.
    std::optional<Vec3> acceleration_mm_s2;
  };
  server::SourceInfo info;
  std::vector<server::RgbdFrame> frames;  ///< with the exact mask
  std::vector<Truth> truth;
  std::vector<double> impacts_s;
};

/// A clip that is drawn when it is needed.
struct NamedBakeClip {
  std::string name;
  std::function<BakeClip()> draw;
};

/// The clips of bodies through sensors of depth, and of things held in hands. `quick`: a few.
std::vector<NamedBakeClip> bakeClips(bool quick);

}  // namespace hapticast::evaluate
