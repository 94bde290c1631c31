// SPDX-License-Identifier: MIT
// Change detection in tiles: decides which tiles of 16 x 16 px are at rest. It compares each frame
// with the held values (the constant values of tiles at rest), over several frames. If a tile has
// changed, it is released: the held values are replaced by new ones. Part of StaticRegionFilter.
// Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Images of one object over a box that consists of whole tiles, or ends at the picture's border.
/// All have the size of the box.
struct HoldImages {
  cv::Mat gray;   ///< CV_32FC1, mean of 3 x 3 px; among held values: the reference for comparisons
  cv::Mat depth;  ///< CV_32FC1, depth in mm; larger is farther
  cv::Mat mask;   ///< CV_8UC1, 0/255
  cv::Mat measured;  ///< CV_8UC1, 255 where `depth` was measured, 0 where it was filled
  int row_step = 1;  ///< only every `row_step`-th row is compared; it counts as `row_step` rows
};

/// Cause of a tile's release: the property that changed in the tile. kNew: the tile is new.
/// kAllDepth: the depth of the whole object changed.
enum class Cause : std::uint8_t { kNone, kNew, kColor, kOutline, kDepth, kAllDepth };

/// State of one tile.
struct Tile {
  // The values were tuned on noisy static scenes and on slow motion, so that no motion is
  // suppressed.
  static constexpr int kSize_px = 16;
  static constexpr int kFrames = 16;  ///< frames of the depth's average; after them it is constant
  static constexpr int kColorFrames = 3;  ///< frames of the average of the reference's grey
  static constexpr int kMaskFrames = 3;   ///< frames until the mask is held
  /// Weight of new values in the tiles beside a released tile, relative to that tile's weight.
  static constexpr double kNeighbour = 0.6;
  /// Frames of a transition to new values, so that no step is perceptible.
  static constexpr int kBlend = 4;

  int frames = 0;              ///< frames at rest so far, at most kFrames
  double evidence = 0;         ///< evidence that depth or outline changed, added up over frames
  double weight = 1.0;         ///< weight of this frame's values in the held values, 0..1
  Cause cause = Cause::kNone;  ///< cause if the tile was released in this frame
  /// Remaining frames of the transition from held to new values; 0: no transition. A release for
  /// kOutline or kDepth starts it at kBlend, a release for any other cause at 1.
  int blending = 0;
  bool mask_held = false;

  [[nodiscard]] bool isLoose() const { return cause != Cause::kNone || blending > 0; }
};

/// Noise of the measured depth of a surface at rest.
struct StaticNoise {
  double sigma_mm = 0.0;  ///< standard deviation of a pixel's depth
  double drift_mm = 1.0;  ///< slow drift of a tile's mean depth; 1 mm for sensors is a choice
  bool clean = false;     ///< the depth has no noise at all
};

/// The tiles of one object, with estimates of the noise. A change counts only if it exceeds the
/// noise. Thread: the one that runs Vision.
class StaticTiles {
 public:
  /// Moves the tiles to another box (px, corners on tiles). Tiles within both boxes retain their
  /// state.
  void moveTo(const cv::Rect& box);
  /// Compares a frame with the held values. Decides for each tile whether it is released, the
  /// weight of the new values, and whether its mask is held. Counts the frame. Returns the grey of
  /// `now`, corrected for changes of exposure. `held` (held values), `last_gray` (of the frame
  /// before) and `now` cover the box. `repeated`: the depth is that of the last frame and thus no
  /// new measurement.
  cv::Mat judge(const HoldImages& held, const cv::Mat& last_gray, const HoldImages& now,
                const StaticNoise& noise, bool repeated);

  [[nodiscard]] const Tile& tile(int column, int row) const {
    return tiles_[static_cast<std::size_t>(row * columns_ + column)];
  }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Returns the cause that released the most pixels of the object in this frame. New tiles (kNew)
  /// do not count. Returns kNone if no other cause released a pixel of the object.
  [[nodiscard]] Cause cause() const { return cause_; }
  /// Returns the rectangle of a tile, px of the box.
  [[nodiscard]] cv::Rect tileRect(int column, int row) const;

 private:
  struct Reading;
  [[nodiscard]] double estimateGain(const HoldImages& held, const HoldImages& now) const;
  [[nodiscard]] Reading readTile(int column, int row, const HoldImages& held,
                                 const cv::Mat& last_gray, const HoldImages& now,
                                 const cv::Mat& core) const;
  static void readSurface(const cv::Rect& rect, const HoldImages& held, const HoldImages& now,
                          const cv::Mat& core, Reading& out);
  void updateNoise(const std::vector<Reading>& readings, double sigma_mm);
  [[nodiscard]] Cause findMoveCause(Tile& tile, const Reading& reading, double drift_mm,
                                    bool repeated) const;
  void release(const std::vector<Reading>& readings, double drift_mm, bool repeated);
  [[nodiscard]] bool haveAllMoved(const std::vector<Reading>& readings, double drift_mm,
                                  bool repeated);
  void weigh(const std::vector<Reading>& readings, bool repeated);

  cv::Rect box_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Tile> tiles_;
  Cause cause_ = Cause::kNone;
  double color_noise_ = kLargestColorNoise;  // noise of the grey levels between successive frames
  double depth_noise_mm_ = -1.0;             // noise of a tile's mean depth; < 0: not measured yet
  double evidence_of_all_ = 0;               // evidence that the depth of the whole object changed

  // A clip that starts in motion must not count its motion as noise.
  static constexpr double kLargestColorNoise = 1.2;
};

}  // namespace hapticast::server
