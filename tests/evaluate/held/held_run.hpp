// SPDX-License-Identifier: MIT
// A held scene through the whole of vision, and through its first step alone. Thread: any; values.
#pragma once

#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/track.hpp"
#include "server/vision/vision_settings.hpp"
#include "tests/scenes/held/scene.hpp"

namespace hapticast::evaluate::held {

/// A scene drawn, with its truth.
struct Recording {
  std::string name;
  server::SourceInfo info;
  server::CameraModel camera;  ///< the one it was drawn with, which the source may not know
  std::vector<server::RgbdFrame> frames;
  std::vector<Truth> truth;
  bool held_at_start = false;
  Object object;
  Sensing sensing;
};
Recording record(const Scene& scene, const cv::Size& size, std::size_t most_frames = 1000);

/// The author's annotations.
struct Words {
  std::vector<server::AuthorPoint> on;
  std::vector<server::AuthorPoint> off;
  std::vector<std::size_t> drawn;  ///< frames whose true mask is given
};

/// The result of vision, frame by frame.
struct Run {
  std::vector<cv::Mat> masks;                        ///< 0 / 255; empty: no object
  std::vector<cv::Mat> heights;                      ///< CV_32FC1, nominal mm; NaN outside
  std::vector<cv::Mat> layers;                       ///< CV_8UC1, layer + 1; 0 outside
  std::vector<std::optional<HapticObject>> largest;  ///< the object, or layer, of most pixels
  std::vector<std::vector<HapticObject>> objects;    ///< all of them, with their layers
  std::vector<double> ms;                            ///< per frame, CPU of the calling thread
  double frames_s = 0.0;                             ///< frames in a second of wall-clock time
  std::optional<server::DepthRange> mapped;          ///< what became heights
  std::string refused;  ///< why there is nothing; empty: it went through
};
Run runVision(const Recording& recording, const Words& words, std::uint64_t threads = 1);
/// The same with the true masks given by the source: what is left is the surface's share.
Run runVisionOnTrueMasks(const Recording& recording);

/// The mask of one frame with which a recording begins; nullopt: refused.
std::optional<cv::Mat> startOf(const server::RgbdFrame& first, const server::SourceInfo& info,
                               const Words& words);

struct Scores {
  double mean_iou = 0.0, worst_iou = 1.0;
  double foreign = 0.0;  ///< share of the object's area, more than 2 px outside of it
  double worst_foreign = 0.0;
  std::size_t lost = 0, frames = 0;  ///< of frames in which a quarter of the object is seen
  double relief_share = 0.0;         ///< of the announced 30 mm that the object's own surface takes
  double cut_share = 0.0;        ///< of its pixels, those that lie at the very ends of the 30 mm
  double velocity_error = -1.0;  ///< rms over that of the true one, in the picture; < 0: it rests
  /// Of the true velocity, the share that is estimated, along x and y; < -1e3: it rests there.
  Vec2 velocity_gain{-1e9, -1e9};
  double wrong_sign = 0.0;  ///< share of the frames with true motion that are the wrong way
  std::size_t blank = 0;    ///< frames without the object where a third of it has been seen a while
  double noise_N = -1.0;    ///< on a finger that does not move; < 0: something does
  double renamed = 0.0;     ///< share of its pixels that change their layer, mean over frames
  double grid_share = -1.0;  ///< of the motion that bending adds, the grid's share; < 0: none
  double median_ms = 0.0, slow_ms = 0.0;  ///< the latter: 95 %
};
Scores scoresOf(const Recording& recording, const Run& run);

/// The mask of all objects that are seen, 0 / 255, of `size`.
cv::Mat collectMask(const std::vector<server::TrackedObject>& objects, const cv::Size& size);

/// The place of `region` (0 / 255) that is farthest from its edge, px; nullopt: it is empty.
std::optional<Vec2> innermost(const cv::Mat& region);

}  // namespace hapticast::evaluate::held
