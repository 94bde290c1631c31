// SPDX-License-Identifier: MIT
#include "server/vision/surface/static_region_filter.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr int kMargin_px = 6;         // chosen: a flickering outline stays within the present tiles
constexpr double kSoftness_px = 3.0;  // chosen: no perceptible edge between tiles
constexpr float kNothing = 0.02F;     // of weight: end of the soft border
constexpr float kMostlyHeld = 0.5F;   // of weight
constexpr double kCleanDrift = 0.1;   // chosen, in steps of rounded depth

// Returns the whole tiles that cover a box and its margin, clipped to the picture.
cv::Rect findTilesAround(const cv::Rect& box, const cv::Size& picture) {
  if (box.empty()) return {};
  const int size = Tile::kSize_px;
  const cv::Point first = box.tl() - cv::Point(kMargin_px, kMargin_px);
  const cv::Point end = box.br() + cv::Point(kMargin_px + size - 1, kMargin_px + size - 1);
  const cv::Point from(std::max(0, first.x) / size * size, std::max(0, first.y) / size * size);
  const cv::Point to(end.x / size * size, end.y / size * size);
  return cv::Rect(from, to) & cv::Rect(cv::Point(), picture);
}

// Returns `image` over `from`, clipped or extended by zeros to `to`.
cv::Mat moveImage(const cv::Mat& image, const cv::Rect& from, const cv::Rect& to, int type) {
  cv::Mat out = cv::Mat::zeros(to.size(), type);
  const cv::Rect common = from & to;
  if (!common.empty()) image(common - from.tl()).copyTo(out(common - to.tl()));
  return out;
}

}  // namespace

StaticNoise computeStaticNoise(const DepthNoise& noise, const Surface& surface) {
  const double depth_mm = cv::mean(surface.depth, surface.mask)[0];
  StaticNoise out{noise.at(depth_mm)};
  // The residue of a flicker trembles like a sensor, even if single frames are clean.
  out.clean = noise.clean(depth_mm) && !noise.flickers;
  if (out.clean) out.drift_mm = kCleanDrift * noise.quantum_mm;
  return out;
}

void StaticRegionFilter::moveTo(const cv::Rect& area) {
  if (area == area_) return;
  held_.gray = moveImage(held_.gray, area_, area, CV_32FC1);
  held_.depth = moveImage(held_.depth, area_, area, CV_32FC1);
  held_.mask = moveImage(held_.mask, area_, area, CV_8UC1);
  held_.measured = moveImage(held_.measured, area_, area, CV_8UC1);
  last_gray_ = moveImage(last_gray_, area_, area, CV_32FC1);
  tiles_.moveTo(area);
  area_ = area;
}

HoldImages StaticRegionFilter::makeTileImages(const cv::Mat& gray, const Surface& now) const {
  HoldImages out;
  cv::boxFilter(gray(area_), out.gray, CV_32F, {3, 3});
  out.depth = moveImage(now.depth, now.box, area_, CV_32FC1);
  out.mask = moveImage(now.mask, now.box, area_, CV_8UC1);
  out.measured = moveImage(now.measured, now.box, area_, CV_8UC1);
  out.row_step = now.reduction;
  return out;
}

void StaticRegionFilter::countPixels() {
  pixels_.clear();
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column)
      pixels_.push_back(cv::countNonZero(held_.mask(tiles_.tileRect(column, row))));
  }
}

// Tiles without the object follow their neighbours: motion behind the object is not its own.
double StaticRegionFilter::computeWeight(int column, int row) const {
  double weight = 0.0;
  for (int v = std::max(0, row - 1); v <= std::min(tiles_.rows() - 1, row + 1); ++v) {
    for (int u = std::max(0, column - 1); u <= std::min(tiles_.columns() - 1, column + 1); ++u) {
      if (countTilePixels(u, v) > 0) weight = std::max(weight, tiles_.tile(u, v).weight);
    }
  }
  return weight;
}

// Returns the weight of this frame for each pixel: one for each tile, with soft borders.
cv::Mat StaticRegionFilter::weights() const {
  cv::Mat out(area_.size(), CV_32FC1);
  double lowest = 1.0;
  double highest = 0.0;
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      const double weight = countTilePixels(column, row) == 0 ? computeWeight(column, row)
                                                              : tiles_.tile(column, row).weight;
      out(tiles_.tileRect(column, row)).setTo(weight);
      lowest = std::min(lowest, weight);
      highest = std::max(highest, weight);
    }
  }
  if (lowest < highest) cv::GaussianBlur(out, out, {}, kSoftness_px);
  return out;
}

void StaticRegionFilter::keepReference(const HoldImages& now) {
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      const int frames = tiles_.tile(column, row).frames;
      if (frames > Tile::kColorFrames) continue;
      const cv::Rect rect = tiles_.tileRect(column, row);
      cv::Mat reference = held_.gray(rect);
      cv::addWeighted(reference, 1 - 1.0 / frames, now.gray(rect), 1.0 / frames, 0, reference);
    }
  }
  last_gray_ = now.gray;
}

void StaticRegionFilter::blend(const HoldImages& now) {
  const auto takesPart = [&](int column, int row) {
    const Tile& tile = tiles_.tile(column, row);
    return !tile.mask_held || tile.weight > 0.0;
  };
  std::vector<cv::Rect> changing;  // with their neighbours, whose borders are soft
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      bool any = false;
      for (int v = std::max(0, row - 1); v <= std::min(tiles_.rows() - 1, row + 1); ++v) {
        for (int u = std::max(0, column - 1); u <= std::min(tiles_.columns() - 1, column + 1); ++u)
          any = any || takesPart(u, v);
      }
      if (any) changing.push_back(tiles_.tileRect(column, row));
    }
  }
  if (changing.empty()) return;
  const cv::Mat weight = weights();
  for (const cv::Rect& rect : changing) {
    const Tile& tile = tiles_.tile(rect.x / Tile::kSize_px, rect.y / Tile::kSize_px);
    blendTile(rect, tile.mask_held, weight, now);
  }
}

void StaticRegionFilter::blendTile(const cv::Rect& rect, bool mask_held, const cv::Mat& weight,
                                   const HoldImages& now) {
  for (int v = rect.y; v < rect.br().y; ++v) {
    const auto* w = weight.ptr<float>(v);
    const auto* new_inside = now.mask.ptr<uchar>(v);
    const auto* new_measured = now.measured.ptr<uchar>(v);
    const auto* new_depth = now.depth.ptr<float>(v);
    auto* inside = held_.mask.ptr<uchar>(v);
    auto* measured = held_.measured.ptr<uchar>(v);
    auto* depth = held_.depth.ptr<float>(v);
    for (int u = rect.x; u < rect.br().x; ++u) {
      const bool had = inside[u] != 0;
      if (!mask_held) inside[u] = new_inside[u];
      if (inside[u] == 0 || new_inside[u] == 0) continue;
      float share = had ? w[u] : 1.0F;
      if (share < kNothing) continue;
      // Measured values take precedence; filled values count only without a measured one.
      if (had && measured[u] != new_measured[u] && share < kMostlyHeld)
        share = new_measured[u] != 0 ? 1.0F : 0.0F;
      depth[u] += share * (new_depth[u] - depth[u]);
      measured[u] = share < 1.0F ? std::max(measured[u], new_measured[u]) : new_measured[u];
    }
  }
}

void StaticRegionFilter::countShare() {
  countPixels();
  int still = 0;
  int all = 0;
  for (int row = 0; row < tiles_.rows(); ++row) {
    for (int column = 0; column < tiles_.columns(); ++column) {
      const int pixels = countTilePixels(column, row);
      all += pixels;
      const Tile& tile = tiles_.tile(column, row);
      if (tile.mask_held && tile.weight <= 0.0) still += pixels;
    }
  }
  share_ = all > 0 ? double(still) / all : 0.0;
}

Surface StaticRegionFilter::surface(const Surface& now) const {
  const cv::Rect tight = cv::boundingRect(held_.mask);
  return {tight + area_.tl(),
          held_.mask(tight).clone(),
          held_.depth(tight).clone(),
          held_.measured(tight) & held_.mask(tight),
          now.quantum_mm,
          now.reduction};
}

Surface StaticRegionFilter::apply(const cv::Mat& gray, const Surface& now, const StaticNoise& noise,
                                  bool repeated) {
  cv::Rect box = now.box;
  if (!area_.empty()) box |= cv::boundingRect(held_.mask) + area_.tl();
  moveTo(findTilesAround(box, gray.size()));
  HoldImages seen = makeTileImages(gray, now);
  countPixels();
  seen.gray = tiles_.judge(held_, last_gray_, seen, noise, repeated);
  blend(seen);
  keepReference(seen);
  countShare();
  if (cv::countNonZero(held_.mask) == 0) return now;
  return surface(now);
}

StaticRegionFilter StaticRegionFilter::copy() const {
  StaticRegionFilter out = *this;
  out.held_ = {held_.gray.clone(), held_.depth.clone(), held_.mask.clone(), held_.measured.clone()};
  out.last_gray_ = last_gray_.clone();
  return out;
}

bool StaticRegionFilter::isUnchanged(const FrameImages& images, const StaticNoise& noise) {
  if (share_ < 1.0) return false;
  // Assumes an unchanged mask and depth that needs no cleaning. If this is wrong, tiles are
  // released and the frame is processed in full.
  const cv::Rect tight = cv::boundingRect(held_.mask);
  Surface now;
  now.box = tight + area_.tl();
  now.mask = held_.mask(tight).clone();
  now.depth = images.depth(now.box).clone();
  now.measured = held_.measured(tight) & (now.depth > 0);
  held_.depth(tight).copyTo(now.depth, now.measured == 0);
  StaticRegionFilter next = copy();
  (void)next.apply(images.gray, now, noise, false);
  if (next.share_ < 1.0) return false;
  *this = next;
  return true;
}

}  // namespace hapticast::server
