// SPDX-License-Identifier: MIT
#include "server/vision/surface/layers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr float kAnyStep_mm = 1e9F;

// Returns the label of the labelled neighbour nearest in depth; 0 if no neighbour is labelled.
uchar nearestLabel(const Surface& surface, const cv::Mat& labels, const cv::Point& at) {
  const cv::Rect whole(cv::Point(), labels.size());
  uchar nearest = 0;
  float smallest = kAnyStep_mm;
  for (int v = at.y - 1; v <= at.y + 1; ++v) {
    for (int u = at.x - 1; u <= at.x + 1; ++u) {
      if (!whole.contains({u, v}) || labels.at<uchar>(v, u) == 0) continue;
      const float off = std::abs(surface.depth.at<float>(v, u) - surface.depth.at<float>(at));
      if (off >= smallest) continue;
      smallest = off;
      nearest = labels.at<uchar>(v, u);
    }
  }
  return nearest;
}

}  // namespace

int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels) {
  const auto [all, areas_px] = findPieces(where);
  std::vector<uchar> name(areas_px.size(), 0);
  int count = 0;
  for (std::size_t i = 1; i < name.size(); ++i) {
    if (areas_px[i] >= smallest_px) name[i] = static_cast<uchar>(++count);
  }
  labels.create(where.size(), CV_8UC1);
  for (int v = 0; v < all.rows; ++v) {
    const auto* from = all.ptr<int>(v);
    auto* to = labels.ptr<uchar>(v);
    for (int u = 0; u < all.cols; ++u) to[u] = name[static_cast<std::size_t>(from[u])];
  }
  return count;
}

std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count) {
  std::vector<double> out;
  for (int i = 1; i <= count; ++i) out.push_back(cv::mean(surface.depth, labels == i)[0]);
  return out;
}

cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds) {
  cv::Mat labels = seeds.clone();
  std::vector<cv::Point> left;
  cv::findNonZero(surface.mask & (labels == 0), left);
  for (std::size_t before = left.size() + 1; !left.empty() && left.size() < before;) {
    before = left.size();
    std::vector<uchar> grown;
    grown.reserve(left.size());
    for (const cv::Point& at : left) grown.push_back(nearestLabel(surface, labels, at));
    std::vector<cv::Point> still;
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (grown[i] == 0) still.push_back(left[i]);
      labels.at<uchar>(left[i]) = grown[i];
    }
    left = std::move(still);
  }
  if (left.empty()) return labels;
  const std::vector<double> depths_mm = meanDepths(surface, labels, count);
  for (const cv::Point& at : left) {
    const auto off = [&](double mean) {
      return std::abs(mean - double(surface.depth.at<float>(at)));
    };
    const auto best = std::min_element(depths_mm.begin(), depths_mm.end(),
                                       [&](double a, double b) { return off(a) < off(b); });
    labels.at<uchar>(at) = static_cast<uchar>(best - depths_mm.begin() + 1);
  }
  return labels;
}

namespace {

// Chosen: a smaller part is not perceived as an object of its own.
constexpr int kSmallest_px = 100;
constexpr double kSmallestShare = 0.02;  // chosen, of the object; likewise
constexpr int kShortestBorder_px = 8;    // chosen: a shorter border is a fold and not a gap
constexpr double kSlope =
    0.25;  // chosen, of a step, for each pixel of a gap: 60 degrees; less than a shadow's
constexpr float kBeyond_mm = 1e9F;

// Returns the measured pixels with a step to another one within their 3 x 3 window. Filled pixels
// do not count, because filling creates no evidence of a step.
cv::Mat steps(const Surface& surface, double step_mm) {
  cv::Mat lowest = surface.depth.clone();
  cv::Mat highest = surface.depth.clone();
  const cv::Mat known = surface.measured & surface.mask;
  lowest.setTo(kBeyond_mm, known == 0);
  highest.setTo(-kBeyond_mm, known == 0);
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8UC1);
  cv::erode(lowest, lowest, around);
  cv::dilate(highest, highest, around);
  return (highest - lowest > step_mm) & known;
}

// For each pixel, the nearest measured pixel.
class NearestMeasured {
 public:
  NearestMeasured(const Surface& surface, const DepthRange& mapped_range)
      : depth_(cv::max(cv::min(surface.depth, mapped_range.far_mm), mapped_range.near_mm)) {
    cv::Mat distance;
    cv::distanceTransform(surface.measured == 0, distance, labels_, cv::DIST_L2, 5,
                          cv::DIST_LABEL_PIXEL);
    for (int v = 0; v < labels_.rows; ++v) {
      for (int u = 0; u < labels_.cols; ++u) {
        if (surface.measured.at<uchar>(v, u) == 0) continue;
        const auto at = static_cast<std::size_t>(labels_.at<int>(v, u));
        if (at >= places_.size()) places_.resize(at + 1);
        places_[at] = {u, v};
      }
    }
  }
  // Returns the difference of depth between two neighbours, minus the effect of a slope over the
  // gap between their measured pixels.
  [[nodiscard]] double step_mm(const cv::Point& p, const cv::Point& q,
                               double slope_mm_per_px) const {
    const cv::Point from = nearestMeasured(p);
    const cv::Point to = nearestMeasured(q);
    const double gap_px = std::max(0.0, cv::norm(to - from) - 1.5);
    const auto off_mm = double(std::abs(depth_.at<float>(from) - depth_.at<float>(to)));
    return off_mm - slope_mm_per_px * gap_px;
  }

 private:
  [[nodiscard]] cv::Point nearestMeasured(const cv::Point& p) const {
    return places_[static_cast<std::size_t>(labels_.at<int>(p))];
  }

  cv::Mat depth_;
  cv::Mat labels_;
  std::vector<cv::Point> places_;
};

// For each pair of pieces: the pixels along their border, and the number of steps among them.
struct Borders {
  int count = 0;
  std::vector<int> pixels;
  std::vector<int> stepping;

  [[nodiscard]] std::size_t index(int a, int b) const {
    return static_cast<std::size_t>(std::min(a, b) * count + std::max(a, b));
  }
  [[nodiscard]] bool step(int a, int b) const {
    const std::size_t i = index(a, b);
    return pixels[i] >= kShortestBorder_px && 2 * stepping[i] >= pixels[i];
  }
};

Borders findBorders(const Surface& surface, const cv::Mat& labels, int count, double step_mm,
                    const DepthRange& mapped_range) {
  Borders out;
  out.count = count;
  out.pixels.assign(static_cast<std::size_t>(count * count), 0);
  out.stepping = out.pixels;
  const NearestMeasured nearest(surface, mapped_range);
  const auto add = [&](const cv::Point& p, const cv::Point& q) {
    const int a = labels.at<uchar>(p);
    const int b = labels.at<uchar>(q);
    if (a == 0 || b == 0 || a == b) return;
    const std::size_t i = out.index(a - 1, b - 1);
    ++out.pixels[i];
    // A step that the sensor blurred over some pixels is smaller between two neighbours.
    out.stepping[i] += nearest.step_mm(p, q, kSlope * step_mm) > 0.5 * step_mm ? 1 : 0;
  };
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      if (u + 1 < labels.cols) add({u, v}, {u + 1, v});
      if (v + 1 < labels.rows) add({u, v}, {u, v + 1});
    }
  }
  return out;
}

// Returns the layer of each piece: one behind the farthest piece in front of it. A piece without a
// step to any other joins the piece nearest in depth.
std::vector<int> groupLayers(const Borders& borders, const std::vector<double>& depths_mm) {
  std::vector<int> order(depths_mm.size());
  std::iota(order.begin(), order.end(), 0);
  const auto depthOf = [&](int i) { return depths_mm[static_cast<std::size_t>(i)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return depthOf(a) < depthOf(b); });
  constexpr int kNone = -1;
  std::vector<int> layer(depths_mm.size(), kNone);
  for (const int piece : order) {
    for (const int other : order) {
      if (other == piece || !borders.step(piece, other)) continue;
      int& mine = layer[static_cast<std::size_t>(piece)];
      const bool behind = depthOf(other) < depthOf(piece);
      const int wanted = behind ? layer[static_cast<std::size_t>(other)] + 1 : 0;
      mine = std::clamp(wanted, std::max(0, mine), kMaxLayers - 1);
    }
  }
  const std::vector<int> stepping = layer;
  for (std::size_t i = 0; i < layer.size(); ++i) {
    if (stepping[i] != kNone) continue;
    layer[i] = 0;
    double nearest_mm = double(kBeyond_mm);
    for (std::size_t k = 0; k < stepping.size(); ++k) {
      const double off_mm = std::abs(depths_mm[k] - depths_mm[i]);
      if (stepping[k] == kNone || off_mm >= nearest_mm) continue;
      nearest_mm = off_mm;
      layer[i] = stepping[k];
    }
  }
  return layer;
}

}  // namespace

Layers findLayers(const Surface& surface, double step_mm, const DepthRange& mapped_range) {
  const cv::Mat step = steps(surface, step_mm);
  if (cv::countNonZero(step) == 0) return {};
  const int area = cv::countNonZero(surface.mask);
  // The number of pieces must fit a byte for any size.
  const int smallest_px = std::max(kSmallest_px, static_cast<int>(kSmallestShare * area));
  Layers out;
  const int pieces = largePieces(surface.mask & surface.measured & ~step, smallest_px, out.labels);
  if (pieces < 2) return {};
  out.labels = grownLabels(surface, pieces, out.labels);
  const std::vector<int> layer =
      groupLayers(findBorders(surface, out.labels, pieces, step_mm, mapped_range),
                  meanDepths(surface, out.labels, pieces));
  out.count = *std::max_element(layer.begin(), layer.end()) + 1;
  if (out.count < 2) return {};
  cv::Mat names = cv::Mat::zeros(1, 256, CV_8UC1);
  for (std::size_t i = 0; i < layer.size(); ++i)
    names.at<uchar>(static_cast<int>(i) + 1) = static_cast<uchar>(layer[i] + 1);
  cv::LUT(out.labels, names, out.labels);
  return out;
}

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
    for (int name = 1; name <= kMaxLayers; ++name) overlaps.push_back({0, layer, name});
  }
  for (int v = 0; v < before.rows; ++v) {
    for (int u = 0; u < before.cols; ++u) {
      const int layer = now.labels.at<uchar>(v, u);
      const int name = before.at<uchar>(v, u);
      if (layer > 0 && name > 0)
        ++overlaps[static_cast<std::size_t>((layer - 1) * kMaxLayers + name - 1)].pixels;
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

// Returns the box around the pixels of each name, from 1 to the largest; empty for an unused name.
std::vector<cv::Rect> findBoxes(const cv::Mat& names) {
  std::vector<cv::Rect> out(kMaxLayers + 1);
  for (int v = 0; v < names.rows; ++v) {
    const auto* row = names.ptr<uchar>(v);
    for (int u = 0; u < names.cols; ++u) out[row[u]] |= cv::Rect(u, v, 1, 1);
  }
  out.erase(out.begin());  // pixels without a name
  while (!out.empty() && out.back().empty()) out.pop_back();
  return out;
}

int countUsed(const std::vector<cv::Rect>& boxes) {
  return static_cast<int>(
      std::count_if(boxes.begin(), boxes.end(), [](const cv::Rect& box) { return !box.empty(); }));
}

Surface cutPart(const Surface& surface, const cv::Mat& names, const cv::Rect& box, double name) {
  if (box.empty()) return {};
  const cv::Mat mask = names(box) == name;
  return {box + surface.box.tl(), mask, surface.depth(box).clone(), surface.measured(box) & mask,
          surface.quantum_mm};
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
  if (countUsed(findBoxes(now)) == countUsed(findBoxes(before))) {
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
  const std::vector<cv::Rect> boxes = findBoxes(names_);
  count_ = names_.empty() ? 1 : countUsed(boxes);
  if (boxes.size() < 2) names_.release();
  if (pending_changes_.size() != surface.box.size())
    pending_changes_ = cv::Mat::zeros(surface.box.size(), CV_8UC1);
  last_mask_ = surface.mask;
  last_box_ = surface.box;
  last_centroid_px_ = computeCentroid(cv::moments(surface.mask, true), surface.box.tl());
  if (names_.empty()) return {surface};
  std::vector<Surface> out;
  out.reserve(boxes.size());
  for (const cv::Rect& box : boxes)
    out.push_back(cutPart(surface, names_, box, double(out.size() + 1)));
  return out;
}

}  // namespace hapticast::server
