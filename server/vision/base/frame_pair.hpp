// SPDX-License-Identifier: MIT
// Pairs each frame with the frame before it, and computes once the data that all objects share:
// working images, depth noise, scene cut, identical repeat. Thread: the one that runs Vision.
#pragma once

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/depth_scale_alignment.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/base/scene_cut.hpp"

namespace hapticast::server {

/// A frame, the frame before it, and the shared results of both.
struct FramePair {
  FrameImages now;
  FrameImages last;                ///< empty in the first frame of a scene
  std::uint64_t index = 0;         ///< index of `now` in the clip
  double clip_time_s = 0.0;        ///< of `now` in the clip, s
  double frame_s = 0.0;            ///< one over the clip's announced rate, s
  double last_clip_time_s = -1.0;  ///< of `last`, s; below 0 in the first frame of a clip
  bool has_key_masks = false;      ///< the author drew key masks for some frames of the clip
  DepthNoise noise;                ///< of the scene's depth, measured in the scene's first frame
  bool cut = false;                ///< `now` is the first frame of another scene
  bool identical = false;          ///< `now` equals `last`; false if the comparison is off
  double interval_s = 0.0;         ///< between `last` and `now`, s
};

/// Pairs the frames of one clip.
class FramePairs {
 public:
  /// Copies `info`. `compare`: whether to detect frames that repeat the last frame.
  FramePairs(const SourceInfo& info, bool compare)
      : info_(info), compare_(compare), flicker_(info.depth_kind) {}

  /// Adds the next frame in order of time and returns it with the frame before. `objects`: last
  /// masks of the objects (CV_8UC1, 0/255, image size), or empty.
  /// The pixels outside `objects` are the background that aligns the depth. Throws SourceError if
  /// the frame does not match `info`.
  FramePair push(const RgbdFrame& frame, double time_s, const cv::Mat& objects = {});
  [[nodiscard]] const DepthNoise& noise() const { return pair_.noise; }

 private:
  SourceInfo info_;
  bool compare_;
  SceneCuts cuts_;
  DepthScaleAlignment flicker_;
  FrameImages raw_;  // last frame from the source, before alignment
  FramePair pair_;
  double time_s_ = 0.0;
};

}  // namespace hapticast::server
