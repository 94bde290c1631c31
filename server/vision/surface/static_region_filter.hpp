// SPDX-License-Identifier: MIT
// Static-region filter: keeps depth and outline of an object constant in the tiles of the picture
// that are at rest. So a static scene causes no noise in the force. In a tile at rest, depth is
// first averaged over some frames and then frozen. Each object has a filter of its own. Thread: the
// one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/surface/static_tiles.hpp"

namespace hapticast::server {

/// Returns the noise parameters of `surface` at rest (StaticNoise). `noise`: noise of the scene's
/// depth.
StaticNoise computeStaticNoise(const DepthNoise& noise, const Surface& surface);

/// Filters the surface of one object, frame by frame.
class StaticRegionFilter {
 public:
  /// Returns the filtered surface of the next frame. In a tile at rest, the depth is averaged over
  /// the tile's first 16 frames at rest and is constant after that. The tile's mask is constant
  /// after 3 frames. In all other tiles the result is `now`, the unfiltered surface, after a
  /// transition of at most 4 frames. Pixels outside the tiles around the object have no influence.
  /// `gray`: the whole picture, CV_8UC1. `repeated`: whether the depth is that of the last frame
  /// and thus no new measurement. Call it once for each frame.
  Surface apply(const cv::Mat& gray, const Surface& now, const StaticNoise& noise, bool repeated);

  /// Returns whether the whole object is at rest and this frame shows it unchanged. If it returns
  /// true, the frame is processed; do not call apply(). If it returns false, the filter is
  /// unchanged; call apply().
  bool isUnchanged(const FrameImages& images, const StaticNoise& noise);

  /// Returns the share of the object, 0..1, in tiles that are at rest and that this frame did not
  /// change. If it is 1, the surface equals the last one bit by bit.
  [[nodiscard]] double share() const { return share_; }
  /// Returns the cause that released tiles in the last frame, so that they are no longer at rest.
  /// kNone: no tile was released.
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
  [[nodiscard]] double computeWeight(int column, int row) const;
  void keepReference(const HoldImages& now);
  void blend(const HoldImages& now);
  void blendTile(const cv::Rect& rect, bool mask_held, const cv::Mat& weight,
                 const HoldImages& now);
  void countShare();
  [[nodiscard]] Surface surface(const Surface& now) const;

  cv::Rect area_;  // px, corners on tiles
  // Held values over area_; gray: the reference. No other object shares these images.
  HoldImages held_;
  cv::Mat last_gray_;
  StaticTiles tiles_;
  std::vector<int> pixels_;  // number of the object's pixels in each tile
  double share_ = 0.0;
};

}  // namespace hapticast::server
