// SPDX-License-Identifier: MIT
// Pairs each frame with the frame before it, and computes once the data that all objects share:
// working images, depth noise, scene cut, identical repeat. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"
#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/depth_scale_alignment.hpp"

namespace hapticast::server {

// Working images of a frame: colour, grey and *working depth* in mm, the common input of all stages
// of vision.
// No code writes into these images (rule in rgbd_source.hpp), so stages share them without copies.
// Thread: the one that runs Vision.

/// Range of 8-bit depth, whose level 255 is near and 0 is far, if neither the source nor the author
/// states a range. Mapped over this range a level h becomes height = h / 255 * 30 mm, as in the
/// thesis.
inline constexpr DepthRange kHeightRange{600.0, 1000.0};

/// Picture width that constants in px assume, px. Larger pictures are sampled more coarsely.
inline constexpr int kUsualWidth_px = 640;

/// Images of one frame, all of one size.
struct FrameImages {
  cv::Mat color;  ///< CV_8UC3, BGR
  cv::Mat gray;   ///< CV_8UC1
  cv::Mat depth;  ///< CV_32FC1, working depth in mm, 0: not measured; finite
  cv::Mat mask;   ///< the source's mask: empty, or CV_8UC1 with n for object n
  /// The author's key mask: empty in most frames, or CV_8UC1 with n for object n; then `mask` is
  /// empty.
  cv::Mat key_mask;
};

// Shot boundary detection: finds the frames at which a clip cuts to another scene, by correlation
// of brightness and change of depth. State of the old scene is invalid after a cut.
// Thread: the one that runs Vision.

/// Compares successive frames at 1/16 of their size. A cut is where both brightness and depth
/// differ from the last frame. Motion, pans and changes of light change only one of them, or both a
/// little.
class SceneCuts {
 public:
  /// Returns whether a cut lies directly before this frame; false for the first frame.
  bool next(const FrameImages& images);

 private:
  cv::Mat gray_;   // CV_32FC1, small
  cv::Mat depth_;  // CV_32FC1, small, mm; 0: not measured
};

/// Converts `frame` to working images. Depths that are not finite, not positive or beyond 100 m
/// count as not measured. Throws SourceError if a type or a size differs from `info`.
FrameImages makeFrameImages(const RgbdFrame& frame, const SourceInfo& info);

/// Returns whether two images of one type have equal pixels. Stops at the first row that differs.
bool equalImages(const cv::Mat& a, const cv::Mat& b);
/// Returns whether colour, depth and masks are equal.
bool equalImages(const FrameImages& a, const FrameImages& b);

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
