// SPDX-License-Identifier: MIT
// Change detection in tiles: compares a frame with the held values, with temporal evidence, and
// decides which tiles are at rest. Part of StaticRegionFilter.
// Thread: the one that runs Vision.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Images of one object over a box of whole tiles (or up to the picture's border), all of the box's
/// size.
struct HoldImages {
  cv::Mat gray;      ///< CV_32FC1, mean of 3x3; of the held images the reference
  cv::Mat depth;     ///< CV_32FC1, working depth in mm
  cv::Mat mask;      ///< CV_8UC1, 0/255
  cv::Mat measured;  ///< CV_8UC1, 255: `depth` is the sensor's own
};

/// Cause of a tile's release.
enum class Cause : std::uint8_t { kNone, kNew, kColor, kOutline, kDepth, kAllDepth };

/// State of one tile.
struct Tile {
  // Tuned on noisy static scenes and on slow motion; chosen so that no motion is suppressed.
  static constexpr int kSize_px = 16;
  static constexpr int kFrames = 16;      ///< frames of the average; then the value is constant
  static constexpr int kColorFrames = 3;  ///< frames of the reference's average
  static constexpr int kMaskFrames = 3;   ///< frames until the mask is held
  /// Weight beside a released tile, relative to that tile's.
  static constexpr double kNeighbour = 0.6;
  static constexpr int kBlend = 4;  ///< frames of a soft transition, without a perceptible step

  int frames = 0;              ///< frames held so far, at most kFrames
  double evidence = 0;         ///< of another depth or outline, over successive frames
  double weight = 1.0;         ///< of this frame in the held value, 0..1
  Cause cause = Cause::kNone;  ///< of a release in this frame
  /// Remaining frames of the transition from held to new values, including this one: one after
  /// motion, more after a change of depth or outline only.
  int blending = 0;
  bool mask_held = false;

  [[nodiscard]] bool loose() const { return cause != Cause::kNone || blending > 0; }
};

/// Noise of depth at rest.
struct StaticNoise {
  double sigma_mm = 0.0;  ///< standard deviation of a pixel
  double drift_mm = 1.0;  ///< drift of a tile: 1 mm for sensors (chosen), less for clean depth
  bool clean = false;     ///< no noise at all
};

/// The tiles of one object, with the noise estimates that judge them. Thread: the one that runs
/// Vision.
class StaticTiles {
 public:
  /// Moves the tiles to another box (px, corners on tiles). Tiles within both boxes retain their
  /// state.
  void moveTo(const cv::Rect& box);
  /// Compares a frame with the held values and decides for each tile: release, weight, held mask.
  /// Counts the frame.
  /// `held`, `last_gray` (the frame before) and `now` cover the box. `repeated`: the depth is no
  /// new observation. Returns the grey of `now` without changes of exposure.
  cv::Mat judge(const HoldImages& held, const cv::Mat& last_gray, const HoldImages& now,
                const StaticNoise& noise, bool repeated);

  [[nodiscard]] const Tile& tile(int column, int row) const {
    return tiles_[static_cast<std::size_t>(row * columns_ + column)];
  }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Cause of most releases of the object in this frame; kNone: no release.
  [[nodiscard]] Cause cause() const { return cause_; }
  /// Returns the pixels of a tile within the box.
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
  [[nodiscard]] Cause moved(Tile& tile, const Reading& reading, double drift_mm,
                            bool repeated) const;
  void release(const std::vector<Reading>& readings, double drift_mm, bool repeated);
  [[nodiscard]] bool allMoved(const std::vector<Reading>& readings, double drift_mm, bool repeated);
  void weigh(const std::vector<Reading>& readings, bool repeated);

  cv::Rect box_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<Tile> tiles_;
  Cause cause_ = Cause::kNone;
  double color_noise_ = kLargestColorNoise;  // levels between successive frames
  double depth_noise_mm_ = -1.0;             // of a tile; < 0: not measured yet
  double evidence_of_all_ = 0;               // of another depth of the whole object

  // A clip that starts in motion must not count its motion as noise.
  static constexpr double kLargestColorNoise = 1.2;
};

}  // namespace hapticast::server
