// SPDX-License-Identifier: MIT
#include "server/vision/surface/static_tiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// Tuned together on static scenes through noisy sensors and on slow motion: static tiles stay held,
// moving tiles are released at once (hold_test).
constexpr int kCore_px = 3;  // inside the held mask
constexpr double kSmallestColorNoise = 0.1;
constexpr double kForget = 1.05;  // for each frame: the noise estimate follows the minimum
constexpr float kDark = 8.0F;     // beyond these levels noise is clipped
constexpr float kBright = 247.0F;
constexpr int kFewestChanged = 64;  // pixels for a valid change of a tile: a quarter of it
constexpr int kFewestPixels = 24;   // of the object; with fewer the whole tile is compared
constexpr int kFewestCore = 32;     // for a mean depth
constexpr std::size_t kFewestTiles = 4;
constexpr std::size_t kFewestForGain = 8;
constexpr int kGainStep_px = 4;   // every fourth pixel and row suffice for a mean
constexpr double kTexture = 3.0;  // levels; below, colour does not show motion
// Evidence of another depth is (off / limit)² for each frame. A small deviation must last longer
// than a large one, but no single frame releases a tile.
constexpr double kMostEvidence = 4;
constexpr double kEnough = 12;
constexpr double kEnoughUntextured = 6;
constexpr double kEnoughOfAll = 4;  // of all tiles alike

double computeEvidence(double off_mm, double limit_mm) {
  const double share = std::abs(off_mm) / limit_mm;
  return share > 1 ? std::min(share * share, kMostEvidence) : 0.0;
}

}  // namespace

// Measurements of one tile in this frame.
struct StaticTiles::Reading {
  bool known = false;        // present in the frame before
  int pixels = 0;            // of the held object
  int flipped = 0;           // whose label differs in the new mask
  int compared = 0;          // pixels whose colour was compared
  double color_change = -1;  // mean since the last frame; < 0: too dark or too bright
  double color_off = 0;      // mean difference to the reference
  double texture = 0;        // standard deviation of the reference
  int core = 0;              // pixels well inside the held object
  int core_lost = 0;         // of these outside the new mask
  int core_measured = 0;
  double depth_off_mm = 0;  // over core_measured, without outliers
};

cv::Rect StaticTiles::tileRect(int column, int row) const {
  const cv::Rect tile(column * Tile::kSize_px, row * Tile::kSize_px, Tile::kSize_px,
                      Tile::kSize_px);
  return tile & cv::Rect(cv::Point(), box_.size());
}

void StaticTiles::moveTo(const cv::Rect& box) {
  if (box == box_) return;
  const int columns = (box.width + Tile::kSize_px - 1) / Tile::kSize_px;
  const int rows = (box.height + Tile::kSize_px - 1) / Tile::kSize_px;
  std::vector<Tile> tiles(static_cast<std::size_t>(columns * rows));
  const int right = (box.x - box_.x) / Tile::kSize_px;
  const int down = (box.y - box_.y) / Tile::kSize_px;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int from_column = column + right;
      const int from_row = row + down;
      if (from_column < 0 || from_column >= columns_ || from_row < 0 || from_row >= rows_) continue;
      tiles[static_cast<std::size_t>(row * columns + column)] = tile(from_column, from_row);
    }
  }
  box_ = box;
  columns_ = columns;
  rows_ = rows;
  tiles_ = std::move(tiles);
}

// Exposure and mains flicker change all tiles equally; the median gain is divided out.
double StaticTiles::estimateGain(const HoldImages& held, const HoldImages& now) const {
  std::vector<double> gains;
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (tile(column, row).frames == 0) continue;
      const cv::Rect rect = tileRect(column, row);
      float before = 0;
      float after = 0;
      for (int v = rect.y; v < rect.br().y; v += kGainStep_px) {
        for (int u = rect.x; u < rect.br().x; u += kGainStep_px) {
          before += held.gray.at<float>(v, u);
          after += now.gray.at<float>(v, u);
        }
      }
      if (before > 0) gains.push_back(double(after / before));
    }
  }
  return gains.size() < kFewestForGain ? 1.0 : std::clamp(computeMedian(gains), 0.5, 2.0);
}

StaticTiles::Reading StaticTiles::readTile(int column, int row, const HoldImages& held,
                                           const cv::Mat& last_gray, const HoldImages& now,
                                           const cv::Mat& core) const {
  Reading out;
  out.known = tile(column, row).frames > 0;
  const cv::Rect rect = tileRect(column, row);
  out.pixels = cv::countNonZero(held.mask(rect));
  if (!out.known) return out;
  const bool whole = out.pixels < kFewestPixels;
  double change = 0, off = 0, sum = 0, square = 0;
  int changed = 0;
  for (int v = rect.y + now.row_step / 2; v < rect.br().y; v += now.row_step) {
    const auto* gray = now.gray.ptr<float>(v);
    const auto* reference = held.gray.ptr<float>(v);
    const auto* last = last_gray.ptr<float>(v);
    const auto* was_inside = held.mask.ptr<unsigned char>(v);
    for (int u = rect.x; u < rect.br().x; ++u) {
      if (gray[u] >= kDark && gray[u] <= kBright) {
        change += now.row_step * double(std::abs(gray[u] - last[u]));
        changed += now.row_step;
      }
      if (!whole && was_inside[u] == 0) continue;
      off += now.row_step * double(std::abs(gray[u] - reference[u]));
      sum += now.row_step * double(reference[u]);
      square += now.row_step * double(reference[u]) * double(reference[u]);
      out.compared += now.row_step;
    }
  }
  if (changed >= kFewestChanged) out.color_change = change / changed;
  const double count = std::max(1, out.compared);
  out.color_off = off / count;
  out.texture = std::sqrt(std::max(0.0, square / count - sum * sum / (count * count)));
  readSurface(rect, held, now, core, out);
  return out;
}

// Measures outline and depth of a tile.
void StaticTiles::readSurface(const cv::Rect& rect, const HoldImages& held, const HoldImages& now,
                              const cv::Mat& core, Reading& out) {
  std::vector<float> offs;
  offs.reserve(static_cast<std::size_t>(rect.area()));
  for (int v = rect.y + now.row_step / 2; v < rect.br().y; v += now.row_step) {
    const auto* was_inside = held.mask.ptr<unsigned char>(v);
    const auto* is_inside = now.mask.ptr<unsigned char>(v);
    const auto* is_core = core.ptr<unsigned char>(v);
    const auto* is_measured = now.measured.ptr<unsigned char>(v);
    const auto* depth = now.depth.ptr<float>(v);
    const auto* held_depth = held.depth.ptr<float>(v);
    for (int u = rect.x; u < rect.br().x; ++u) {
      out.flipped += was_inside[u] != is_inside[u] ? now.row_step : 0;
      if (is_core[u] == 0) continue;
      out.core += now.row_step;
      out.core_lost += is_inside[u] == 0 ? now.row_step : 0;
      if (is_measured[u] == 0) continue;
      offs.push_back(depth[u] - held_depth[u]);
      out.core_measured += now.row_step;
    }
  }
  out.depth_off_mm = computeMiddleMean(offs);
}

void StaticTiles::updateNoise(const std::vector<Reading>& readings, double sigma_mm) {
  std::vector<double> changes;
  std::vector<double> offs;
  for (const Reading& reading : readings) {
    if (reading.color_change >= 0) changes.push_back(reading.color_change);
    if (reading.core_measured >= kFewestCore) offs.push_back(reading.depth_off_mm);
  }
  color_noise_ *= kForget;
  if (!changes.empty()) {
    const auto quartile = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 4);
    std::nth_element(changes.begin(), quartile, changes.end());
    color_noise_ = std::min(color_noise_, *quartile);
  }
  color_noise_ = std::clamp(color_noise_, kSmallestColorNoise, kLargestColorNoise);
  const double largest_mm = std::max(0.3, sigma_mm);
  depth_noise_mm_ = depth_noise_mm_ < 0 ? largest_mm : depth_noise_mm_ * kForget;
  if (offs.size() >= kFewestTiles) {
    const double median = computeMedian(offs);
    for (double& off : offs) off = std::abs(off - median);
    depth_noise_mm_ = std::min(depth_noise_mm_, sigmaByMedian(offs));
  }
  depth_noise_mm_ = std::clamp(depth_noise_mm_, 0.02, largest_mm);
}

Cause StaticTiles::findMoveCause(Tile& tile, const Reading& reading, double drift_mm,
                                 bool repeated) const {
  if (!reading.known) return Cause::kNew;
  // The mean over few pixels of a tile scatters more.
  const double spread = 2.5 + 4 / std::sqrt(double(std::max(1, reading.compared)));
  if (reading.color_off > spread * color_noise_ + 0.5) return Cause::kColor;
  double outline = 2 * reading.flipped > std::max(kFewestPixels, reading.pixels) ? 1.0 : 0.0;
  if (2 * reading.core_lost > reading.core) outline = kMostEvidence;
  double depth = 0.0;
  if (!repeated && reading.core_measured >= kFewestCore)
    depth = computeEvidence(reading.depth_off_mm, 5 * depth_noise_mm_ + drift_mm);
  const double evidence = std::min(outline + depth, kMostEvidence);
  if (evidence > 0 || !repeated) tile.evidence = evidence > 0 ? tile.evidence + evidence : 0.0;
  if (tile.evidence < (reading.texture < kTexture ? kEnoughUntextured : kEnough))
    return Cause::kNone;
  return outline > depth ? Cause::kOutline : Cause::kDepth;
}

// A drift of the whole object in depth shows sooner, and at smaller deviations, than in a single
// tile.
bool StaticTiles::haveAllMoved(const std::vector<Reading>& readings, double drift_mm,
                               bool repeated) {
  if (repeated) return false;
  std::vector<double> offs;
  for (const Reading& reading : readings) {
    if (reading.core_measured >= kFewestCore) offs.push_back(reading.depth_off_mm);
  }
  const double evidence =
      offs.size() < kFewestTiles
          ? 0.0
          : computeEvidence(computeMedian(offs), 2 * depth_noise_mm_ + drift_mm);
  evidence_of_all_ = evidence > 0 ? evidence_of_all_ + evidence : 0.0;
  return evidence_of_all_ >= kEnoughOfAll;
}

void StaticTiles::weigh(const std::vector<Reading>& readings, bool repeated) {
  for (Tile& tile : tiles_) {
    const bool averaging = tile.frames < Tile::kFrames && !repeated;
    tile.weight =
        tile.blending > 0 ? 1.0 / tile.blending : (averaging ? 1.0 / (tile.frames + 1) : 0.0);
    tile.mask_held = !tile.isLoose() && tile.frames >= Tile::kMaskFrames;
  }
  std::vector<double> beside(tiles_.size(), 0.0);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const auto index = static_cast<std::size_t>(row * columns_ + column);
      // Motion in the background does not affect the object beside it.
      if (!tiles_[index].isLoose() || !readings[index].known) continue;
      if (readings[index].pixels == 0 && readings[index].flipped == 0) continue;
      for (int v = std::max(0, row - 1); v <= std::min(rows_ - 1, row + 1); ++v) {
        for (int u = std::max(0, column - 1); u <= std::min(columns_ - 1, column + 1); ++u) {
          double& weight = beside[static_cast<std::size_t>(v * columns_ + u)];
          weight = std::max(weight, Tile::kNeighbour * tiles_[index].weight);
        }
      }
    }
  }
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    if (beside[i] == 0.0) continue;
    tiles_[i].weight = std::max(tiles_[i].weight, beside[i]);
    tiles_[i].mask_held = false;
  }
}

// Decides the released tiles and the speed of their transition to the new values: at once for
// motion, softly for a mere change of depth.
void StaticTiles::release(const std::vector<Reading>& readings, double drift_mm, bool repeated) {
  const bool all = haveAllMoved(readings, drift_mm, repeated);
  if (all) evidence_of_all_ = 0;
  std::array<int, 6> pixels{};
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    tile.cause = findMoveCause(tile, readings[i], drift_mm, repeated);
    if (all && readings[i].known && tile.cause != Cause::kColor) tile.cause = Cause::kAllDepth;
    const bool soft = tile.cause == Cause::kOutline || tile.cause == Cause::kDepth;
    if (soft && tile.blending == 0) tile.blending = Tile::kBlend;
    if (!soft && tile.cause != Cause::kNone) tile.blending = 1;
    pixels[static_cast<std::size_t>(tile.cause)] += readings[i].pixels;
  }
  const auto most = std::max_element(pixels.begin() + 2, pixels.end());
  cause_ = *most > 0 ? static_cast<Cause>(most - pixels.begin()) : Cause::kNone;
}

cv::Mat StaticTiles::judge(const HoldImages& held, const cv::Mat& last_gray, const HoldImages& seen,
                           const StaticNoise& noise, bool repeated) {
  const cv::Mat gray = seen.gray / estimateGain(held, seen);
  const HoldImages now{gray, seen.depth, seen.mask, seen.measured, seen.row_step};
  const cv::Mat core = erodeBy(held.mask, kCore_px);
  std::vector<Reading> readings;
  readings.reserve(tiles_.size());
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column)
      readings.push_back(readTile(column, row, held, last_gray, now, core));
  }
  updateNoise(readings, noise.sigma_mm);
  release(readings, noise.drift_mm, repeated);
  weigh(readings, repeated);
  for (Tile& tile : tiles_) {
    if (tile.isLoose()) {
      tile.blending = std::max(0, tile.blending - 1);
      tile.frames = 1;
      tile.evidence = 0;
    } else if (!repeated) {
      tile.frames = std::min(tile.frames + 1, Tile::kFrames);
    }
  }
  return now.gray;
}

}  // namespace hapticast::server
