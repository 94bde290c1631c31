// SPDX-License-Identifier: MIT
// Stillness: what is at rest keeps its depth and its outline, tile by tile, so that a still scene
// feels perfectly still although the sensor is noisy. One per object. Thread: vision's.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/surface/static_tiles.hpp"

namespace hapticast::server {

/// What the depth of `surface` reads while it is at rest.
StaticNoise computeStaticNoise(const DepthNoise& noise, const Surface& surface);

class StaticRegionFilter {
 public:
  /// The surface of the next frame as it is to be felt: averaged over the first 16 frames and then
  /// kept, depth and mask, in tiles at rest; `now` elsewhere. `gray`: the whole picture, CV_8UC1.
  /// `repeated`: this depth is no new observation. Reads the object's box only.
  Surface apply(const cv::Mat& gray, const Surface& now, const StaticNoise& noise, bool repeated);

  /// Whether a frame shows the object as it is held, all of it at rest: then the frame is counted
  /// as apply() would have. Else nothing is changed.
  bool isUnchanged(const FrameImages& images, const StaticNoise& noise);

  /// The part of the object, 0..1, that lies in tiles at rest, unchanged by this frame. 1: the
  /// surface equals the last frame's bit by bit.
  [[nodiscard]] double share() const { return share_; }
  /// Why the last frame released something of the object; kNone: it did not.
  [[nodiscard]] Cause cause() const { return tiles_.cause(); }

 private:
  [[nodiscard]] StaticRegionFilter copy() const;
  void moveTo(const cv::Rect& area);
  [[nodiscard]] HoldImages makeTileImages(const cv::Mat& gray, const Surface& now) const;
  void countPixels();
  [[nodiscard]] int countTilePixels(int column, int row) const {
    return pixels_[static_cast<std::size_t>(row * tiles_.columns() + column)];
  }
  [[nodiscard]] cv::Mat weights() const;
  [[nodiscard]] double weightAround(int column, int row) const;
  void keepReference(const HoldImages& now);
  void blend(const HoldImages& now);
  void blendTile(const cv::Rect& rect, bool mask_held, const cv::Mat& weight,
                 const HoldImages& now);
  void countShare();
  [[nodiscard]] Surface surface(double quantum_mm) const;

  cv::Rect area_;    // px, corners on tiles
  HoldImages held_;  // over area_; gray: the reference. Nobody else has these images
  cv::Mat last_gray_;
  StaticTiles tiles_;
  std::vector<int> pixels_;  // of the object, per tile
  double share_ = 0.0;
};

}  // namespace hapticast::server
