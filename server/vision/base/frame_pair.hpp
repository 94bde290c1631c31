// SPDX-License-Identifier: MIT
// What all objects of a frame share, derived from it once: its working images beside those of the
// frame before, the noise of its depth, whether it cuts to another scene or repeats the last frame.
// Thread: the one that runs Vision.
#pragma once

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/depth_scale_alignment.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/base/scene_cut.hpp"

namespace hapticast::server {

/// A frame and the one before it.
struct FramePair {
  FrameImages now;
  FrameImages last;         ///< empty in the first frame of a scene
  std::uint64_t index = 0;  ///< of `now` in the clip
  double clip_time_s = 0.0;
  double frame_s = 0.0;            ///< one over the clip's announced rate
  double last_clip_time_s = -1.0;  ///< of `last`; below 0 in the first frame of a clip
  bool has_key_masks = false;      ///< the author drew some frames of the clip
  DepthNoise noise;                ///< of the scene's depth, measured in its first frame
  bool cut = false;                ///< `now` is the first frame of another scene
  bool identical = false;          ///< `now` shows what `last` showed, and it matters
  double interval_s = 0.0;         ///< between the two
};

/// Takes the frames of a clip in and pairs each with the one before.
class FramePairs {
 public:
  /// `info` is copied. `compare`: whether frames that repeat the last one are to be told.
  FramePairs(const SourceInfo& info, bool compare)
      : info_(info), compare_(compare), flicker_(info.depth_kind) {}

  /// The next frame in order of time. Throws SourceError where it does not fit the announcement.
  /// `objects`: where objects were, 0 / 255, size of the picture, or empty: what of the depth is
  /// the background's, by which it is kept from flickering.
  FramePair push(const RgbdFrame& frame, double time_s, const cv::Mat& objects = {});
  [[nodiscard]] const DepthNoise& noise() const { return pair_.noise; }

 private:
  SourceInfo info_;
  bool compare_;
  SceneCuts cuts_;
  DepthScaleAlignment flicker_;
  FrameImages raw_;  // the last frame as the source gave it
  FramePair pair_;
  double time_s_ = 0.0;
};

}  // namespace hapticast::server
