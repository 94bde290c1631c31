// SPDX-License-Identifier: MIT
// Pairs each frame with the frame before it. It also computes the data that all objects share:
// working images, depth noise, whether the scene was cut, and whether the frame repeats the last
// frame. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"
#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/depth_scale_alignment.hpp"
#include "server/vision/base/reduction.hpp"

namespace hapticast::server {

/// Working depths of 8-bit levels, if neither the source nor the author states a range. Level 255
/// (near) becomes 600 mm and level 0 (far) becomes 1000 mm. If this range is also the mapped range,
/// level h has the height h / 255 * 30 mm, as in the thesis.
inline constexpr DepthRange kHeightRange{600.0, 1000.0};

/// Images of one frame, all of one size. *Working depth* is the depth in mm that all stages of
/// vision use, whatever the source delivers; larger values are farther. No code writes into these
/// images (rule in rgbd_source.hpp), so stages share them without copies. Thread: the one that runs
/// Vision.
struct FrameImages {
  cv::Mat color;  ///< CV_8UC3, BGR
  cv::Mat gray;   ///< CV_8UC1
  cv::Mat depth;  ///< CV_32FC1, working depth in mm, 0: not measured; finite
  cv::Mat mask;   ///< the source's mask: empty, or CV_8UC1 with n for object n
  /// The author's key mask of this frame: CV_8UC1 with n for object n. It is empty in most frames.
  /// If it is not empty, `mask` is empty.
  cv::Mat key_mask;
};

/// Finds the frames at which a clip cuts to another scene. It compares successive frames at 1/16 of
/// their size. A cut is where brightness and depth both differ strongly from the last frame.
/// Motion, pans and changes of light change only one of them, or change both a little. After a cut,
/// callers must discard their state of the old scene. Thread: the one that runs Vision.
class SceneCuts {
 public:
  /// Returns whether `images` is the first frame after a cut. Returns false for the very first
  /// frame. Call it for each frame in order.
  bool next(const FrameImages& images);

 private:
  cv::Mat gray_;   // last frame's grey at 1/16 of its size, CV_32FC1
  cv::Mat depth_;  // last frame's depth at 1/16 of its size, CV_32FC1, mm; 0: not measured
};

/// Returns the working images of `frame`. Depths that are not finite, not positive or beyond 100 m
/// count as not measured. Throws SourceError if a type or a size differs from `info`.
FrameImages makeFrameImages(const RgbdFrame& frame, const SourceInfo& info);

/// Returns whether two images of one type have equal pixels. The comparison ends at the first row
/// with a difference.
bool equalImages(const cv::Mat& a, const cv::Mat& b);
/// Returns whether two frames have equal colour, depth and masks.
bool equalImages(const FrameImages& a, const FrameImages& b);

/// A frame, the frame before it, and the shared results of both.
struct FramePair {
  FrameImages now;
  FrameImages last;            ///< empty in the first frame of a scene
  std::uint64_t index = 0;     ///< index of `now` in the clip
  double clip_time_s = 0.0;    ///< time of `now` in the clip, s
  Vec2 own_px = Vec2::Ones();  ///< SourceInfo::own_px
  double frame_s = 0.0;        ///< duration of a frame at the source's stated frame rate, s
  /// Time of `last` in the clip, s; below 0 in the first frame of a clip.
  double last_clip_time_s = -1.0;
  bool has_key_masks = false;  ///< the author drew key masks for some frames of the clip
  DepthNoise noise;            ///< noise of the scene's depth, measured in the scene's first frame
  bool cut = false;            ///< `now` is the first frame of another scene
  bool identical = false;      ///< `now` equals `last`; always false if the comparison is off
  double interval_s = 0.0;     ///< time between `last` and `now`, s
};

/// Pairs the frames of one clip.
class FramePairs {
 public:
  /// Copies `info`. `compare`: whether to detect frames that repeat the frame before them.
  FramePairs(const SourceInfo& info, bool compare)
      : info_(info), compare_(compare), flicker_(info.depth_kind, info.estimated) {}

  /// Adds the next frame, in order of time, and returns it with the frame before it. `objects`:
  /// last masks of all objects (CV_8UC1, 0/255, size of the image), or empty. DepthScaleAlignment
  /// uses the pixels outside `objects` as the background. `time_s`: time of the frame, s. Throws
  /// SourceError if the frame does not match `info`.
  FramePair push(const RgbdFrame& frame, double time_s, const cv::Mat& objects = {});
  [[nodiscard]] const DepthNoise& noise() const { return pair_.noise; }

 private:
  SourceInfo info_;
  bool compare_;
  SceneCuts cuts_;
  DepthScaleAlignment flicker_;
  FrameImages raw_;  // last frame from the source, before sharpening and alignment
  FramePair pair_;
  double time_s_ = 0.0;
};

}  // namespace hapticast::server
