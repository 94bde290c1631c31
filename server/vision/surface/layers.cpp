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
uchar findNearestLabel(const Surface& surface, const cv::Mat& labels, const cv::Point& at) {
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

cv::Mat growLabels(const Surface& surface, int count, const cv::Mat& seeds) {
  cv::Mat labels = seeds.clone();
  std::vector<cv::Point> left;
  cv::findNonZero(surface.mask & (labels == 0), left);
  for (std::size_t before = left.size() + 1; !left.empty() && left.size() < before;) {
    before = left.size();
    std::vector<uchar> grown;
    grown.reserve(left.size());
    for (const cv::Point& at : left) grown.push_back(findNearestLabel(surface, labels, at));
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
  // gap between their measured pixels. A pixel here is `reduction` px of the picture wide.
  [[nodiscard]] double step_mm(const cv::Point& p, const cv::Point& q, double slope_mm_per_px,
                               int reduction) const {
    const cv::Point from = findNearestMeasured(p);
    const cv::Point to = findNearestMeasured(q);
    const double gap_px = std::max(0.0, reduction * cv::norm(to - from) - 1.5);
    const auto off_mm = double(std::abs(depth_.at<float>(from) - depth_.at<float>(to)));
    return off_mm - slope_mm_per_px * gap_px;
  }

 private:
  [[nodiscard]] cv::Point findNearestMeasured(const cv::Point& p) const {
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
                    const DepthRange& mapped_range, int reduction) {
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
    const double step = nearest.step_mm(p, q, kSlope * step_mm, reduction);
    out.stepping[i] += step > 0.5 * step_mm ? 1 : 0;
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

cv::Mat findSteps(const Surface& surface, double step_mm) {
  cv::Mat lowest = surface.depth.clone();
  cv::Mat highest = surface.depth.clone();
  // Filled pixels do not count, because filling creates no evidence of a step.
  const cv::Mat known = surface.measured & surface.mask;
  lowest.setTo(kBeyond_mm, known == 0);
  highest.setTo(-kBeyond_mm, known == 0);
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8UC1);
  cv::erode(lowest, lowest, around);
  cv::dilate(highest, highest, around);
  return (highest - lowest > step_mm) & known;
}

Layers findLayers(const Surface& surface, double step_mm, const DepthRange& mapped_range) {
  return findLayers(surface, findSteps(surface, step_mm), step_mm, mapped_range);
}

Layers findLayers(const Surface& surface, const cv::Mat& step, double step_mm,
                  const DepthRange& mapped_range, int reduction) {
  if (cv::countNonZero(step) == 0) return {};
  const int area = cv::countNonZero(surface.mask);
  // The number of pieces must fit a byte for any size.
  const int smallest_px = std::max(kSmallest_px, static_cast<int>(kSmallestShare * area));
  Layers out;
  const int pieces = largePieces(surface.mask & surface.measured & ~step, smallest_px, out.labels);
  if (pieces < 2) return {};
  out.labels = growLabels(surface, pieces, out.labels);
  const std::vector<int> layer =
      groupLayers(findBorders(surface, out.labels, pieces, step_mm, mapped_range, reduction),
                  meanDepths(surface, out.labels, pieces));
  out.count = *std::max_element(layer.begin(), layer.end()) + 1;
  if (out.count < 2) return {};
  cv::Mat names = cv::Mat::zeros(1, 256, CV_8UC1);
  for (std::size_t i = 0; i < layer.size(); ++i)
    names.at<uchar>(static_cast<int>(i) + 1) = static_cast<uchar>(layer[i] + 1);
  cv::LUT(out.labels, names, out.labels);
  return out;
}

}  // namespace hapticast::server
