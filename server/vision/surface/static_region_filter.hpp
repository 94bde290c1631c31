// SPDX-License-Identifier: MIT
// Static-region filter: holds depth and outline of tiles at rest constant (temporal averaging, then
// a freeze), so that a static scene causes no force noise. One for each object. Thread: the one
// that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/surface/static_tiles.hpp"

namespace hapticast::server {

/// Returns the noise of the depth of `surface` at rest.
StaticNoise computeStaticNoise(const DepthNoise& noise, const Surface& surface);

/// Filter of one object.
class StaticRegionFilter {
 public:
  /// Returns the filtered surface of the next frame: depth and mask of tiles at rest are averaged
  /// over their first 16 frames and then constant. Other tiles are those of `now`.
  /// `gray`: the whole picture, CV_8UC1. `repeated`: the depth is no new observation. Reads the
  /// object's box only.
  Surface apply(const cv::Mat& gray, const Surface& now, const StaticNoise& noise, bool repeated);

  /// Returns whether the frame shows the held object, all of it at rest; then it counts the frame
  /// like apply(). Otherwise the filter does not change.
  bool isUnchanged(const FrameImages& images, const StaticNoise& noise);

  /// Returns the share of the object, 0..1, in tiles at rest that this frame did not change. 1: the
  /// surface equals the last one bit by bit.
  [[nodiscard]] double share() const { return share_; }
  /// Returns the cause of the last frame's release; kNone: no release.
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
  HoldImages held_;  // over area_; gray: the reference. No other object shares these images
  cv::Mat last_gray_;
  StaticTiles tiles_;
  std::vector<int> pixels_;  // of the object, for each tile
  double share_ = 0.0;
};

}  // namespace hapticast::server
