// SPDX-License-Identifier: MIT
// What the tiles of a picture show against what is held of them, and which are at rest. Used by
// Hold.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// One object over a box whose corners are corners of tiles (or of the picture): all images are of
/// the box's size.
struct HoldImages {
  cv::Mat gray;      ///< CV_32FC1, mean of 3x3; of the held ones the reference
  cv::Mat depth;     ///< CV_32FC1, working depth in mm
  cv::Mat mask;      ///< CV_8UC1, 0 / 255
  cv::Mat measured;  ///< CV_8UC1, 255 where `depth` is the sensor's own
};

/// Why a tile is no longer held.
enum class Cause : std::uint8_t { kNone, kNew, kColor, kOutline, kDepth, kAllDepth };

struct Tile {
  // Tried together on noisy still scenes and on slow motion; chosen where no motion was held back.
  static constexpr int kSize_px = 16;
  static constexpr int kFrames = 16;         ///< averaged; from then on nothing changes
  static constexpr int kColorFrames = 3;     ///< averaged in the reference
  static constexpr int kMaskFrames = 3;      ///< until the mask is held
  static constexpr double kNeighbour = 0.6;  ///< weight beside a released tile, of its own
  static constexpr int kBlend = 4;           ///< frames: nothing that rests is felt to step

  int frames = 0;              ///< held so far, at most kFrames
  double evidence = 0;         ///< of another depth or outline, over frames in a row
  double weight = 1.0;         ///< of this frame in what is held
  Cause cause = Cause::kNone;  ///< of its release in this frame
  /// Frames in which what is held goes over into what is seen, this one included: one where it
  /// moves, more where only depth or outline are another.
  int blending = 0;
  bool mask_held = false;

  [[nodiscard]] bool loose() const { return cause != Cause::kNone || blending > 0; }
};

/// What depth reads of something at rest.
struct StaticNoise {
  double sigma_mm = 0.0;  ///< of a pixel
  double drift_mm = 1.0;  ///< of a tile: sensors wander (1 mm is chosen); clean depth does not
  bool clean = false;     ///< nothing trembles
};

/// The tiles of one object and the noise they are judged by. Thread: vision's.
class StaticTiles {
 public:
  /// Tiles over another box (px, corners on tiles); those of both boxes stay.
  void moveTo(const cv::Rect& box);
  /// Compares a frame with what is held: `held`, `last_gray` (the frame before) and `now` over the
  /// box. `repeated`: this depth is no new observation. Decides for every tile whether it is
  /// released, its weight and whether its mask is held, and counts the frame. Returns the grey of
  /// `now` with changes of exposure divided out.
  cv::Mat judge(const HoldImages& held, const cv::Mat& last_gray, const HoldImages& now,
                const StaticNoise& noise, bool repeated);

  [[nodiscard]] const Tile& tile(int column, int row) const {
    return tiles_[static_cast<std::size_t>(row * columns_ + column)];
  }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Why most of what was released in this frame was; kNone: nothing of the object was.
  [[nodiscard]] Cause cause() const { return cause_; }
  /// Pixels of a tile within the box.
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
  double color_noise_ = kLargestColorNoise;  // levels, from frame to frame
  double depth_noise_mm_ = -1.0;             // of a tile; < 0: not known yet
  double evidence_of_all_ = 0;               // of another depth of the whole object

  // A clip that starts in motion must not take its motion for noise.
  static constexpr double kLargestColorNoise = 1.2;
};

}  // namespace hapticast::server
