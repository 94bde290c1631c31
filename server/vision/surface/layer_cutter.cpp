// SPDX-License-Identifier: MIT
#include "server/vision/surface/layer_cutter.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/surface/labels.hpp"

namespace hapticast::server {

namespace {

constexpr double kKeptStep = 0.7;  // chosen, of the step that caused a cut: limit to remove the cut
constexpr int kFramesToChange = 3;  // chosen, in a row: noise lasts one or two
constexpr int kFollows_px = 2;      // chosen: motion of an edge in a frame relative to its surface
constexpr int kCrumb_px = 30;       // chosen: smaller rests of a name are removed

// Returns the layers of `now` with the names of those layers of `before` that they overlap most.
cv::Mat named(const Layers& now, const cv::Mat& before) {
  struct Overlap {
    int pixels, layer, name;
  };
  std::vector<Overlap> overlaps;
  overlaps.reserve(static_cast<std::size_t>(now.count * kMaxLayers));
  for (int layer = 1; layer <= now.count; ++layer) {
    for (int name = 1; name <= kMaxLayers; ++name) {
      const int pixels = cv::countNonZero((now.labels == layer) & (before == name));
      overlaps.push_back({pixels, layer, name});
    }
  }
  std::stable_sort(overlaps.begin(), overlaps.end(),
                   [](const Overlap& a, const Overlap& b) { return a.pixels > b.pixels; });
  cv::Mat names = cv::Mat::zeros(1, 256, CV_8UC1);
  std::array<bool, kMaxLayers + 1> taken{};
  for (const Overlap& overlap : overlaps) {
    auto& name = names.at<uchar>(overlap.layer);
    if (name != 0 || taken[static_cast<std::size_t>(overlap.name)]) continue;
    name = static_cast<uchar>(overlap.name);
    taken[static_cast<std::size_t>(overlap.name)] = true;
  }
  cv::Mat out;
  cv::LUT(now.labels, names, out);
  return out;
}

// Assigns small components of a name to their neighbours.
cv::Mat withoutSmallComponents(const Surface& surface, const cv::Mat& names) {
  cv::Mat seeds = cv::Mat::zeros(names.size(), CV_8UC1);
  for (int name = 1; name <= kMaxLayers; ++name) {
    cv::Mat pieces;
    if (largePieces(names == name, kCrumb_px, pieces) > 0) seeds.setTo(name, pieces > 0);
  }
  return cv::countNonZero(seeds) > 0 ? grownLabels(surface, kMaxLayers, seeds) : names.clone();
}

Surface cutPart(const Surface& surface, const cv::Mat& mask) {
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return {};
  return {box + surface.box.tl(), mask(box).clone(), surface.depth(box).clone(),
          surface.measured(box) & mask(box), surface.quantum_mm};
}

int countNames(const cv::Mat& names) {
  int count = 0;
  for (int name = 1; name <= kMaxLayers; ++name)
    count += cv::countNonZero(names == name) > 0 ? 1 : 0;
  return count;
}

}  // namespace

// Returns the last frame's image over its box, moved with the object.
cv::Mat LayerCutter::warpedNames(const cv::Mat& image, const Surface& surface) const {
  const cv::Point2d moved =
      computeCentroid(cv::moments(surface.mask, true), surface.box.tl()) - last_centroid_px_;
  const cv::Rect from = last_box_ + cv::Point(cvRound(moved.x), cvRound(moved.y));
  cv::Mat out = cv::Mat::zeros(surface.box.size(), CV_8UC1);
  const cv::Rect common = from & surface.box;
  if (!common.empty()) image(common - from.tl()).copyTo(out(common - surface.box.tl()));
  out.setTo(0, surface.mask == 0);
  return out;
}

// A pixel changes its name after three successive frames, or where the edge between two names moves
// a little.
cv::Mat LayerCutter::isSettled(const Surface& surface, const cv::Mat& now, const cv::Mat& before) {
  cv::Mat doubts = warpedNames(pending_changes_, surface);
  const cv::Mat differs = (now != before) & (before > 0);
  cv::add(doubts, 1, doubts, differs);
  doubts.setTo(0, ~differs);
  cv::Mat changes = (doubts >= kFramesToChange) | (before == 0);
  if (countNames(now) == countNames(before)) {
    for (int name = 1; name <= kMaxLayers; ++name)
      changes |= differs & (now == name) & dilatedBy(before == name, kFollows_px);
  }
  changes &= surface.mask;
  cv::Mat names = before.clone();
  now.copyTo(names, changes);
  doubts.setTo(0, changes);
  pending_changes_ = doubts;
  return withoutSmallComponents(surface, names);
}

cv::Mat LayerCutter::assignNames(const Surface& surface, double step_mm,
                                 const DepthRange& mapped_range) {
  Layers now = findLayers(surface, step_mm * (count_ > 1 ? kKeptStep : 1.0), mapped_range);
  if (now.count < 2 && names_.empty()) {
    pending_changes_.release();
    return {};
  }
  if (now.count < 2) now.labels = surface.mask / 255;
  if (count_ == 0) return now.labels;
  const cv::Mat before = warpedNames(names_.empty() ? last_mask_ / 255 : names_, surface);
  if (cv::countNonZero(before) == 0) return now.count < 2 ? cv::Mat() : now.labels;
  return isSettled(surface, named(now, before), before);
}

std::vector<Surface> LayerCutter::cut(const Surface& surface, double step_mm,
                                      const DepthRange& mapped_range) {
  names_ = assignNames(surface, step_mm, mapped_range);
  count_ = names_.empty() ? 1 : countNames(names_);
  if (!names_.empty() && cv::countNonZero(names_ > 1) == 0) names_.release();
  if (pending_changes_.size() != surface.box.size())
    pending_changes_ = cv::Mat::zeros(surface.box.size(), CV_8UC1);
  last_mask_ = surface.mask;
  last_box_ = surface.box;
  last_centroid_px_ = computeCentroid(cv::moments(surface.mask, true), surface.box.tl());
  if (names_.empty()) return {surface};
  std::vector<Surface> out;
  out.reserve(kMaxLayers);
  for (int name = 1; name <= kMaxLayers; ++name) out.push_back(cutPart(surface, names_ == name));
  while (out.back().box.empty()) out.pop_back();
  return out;
}

}  // namespace hapticast::server
