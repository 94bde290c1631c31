// SPDX-License-Identifier: MIT
#include "server/vision/surface/layers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

constexpr int kSmallest_px = 100;  // chosen: what is smaller is not felt as a thing of its own
constexpr double kSmallestShare = 0.02;  // chosen, likewise, of the object
constexpr int kShortestBorder_px = 8;    // chosen: a shorter border is a fold, no gap
constexpr double kKeptStep = 0.7;   // chosen, of the step that made a cut: until it is given up
constexpr int kFramesToChange = 3;  // chosen, in a row: noise makes one or two
constexpr float kBeyond_mm = 1e9F;

// Pixels of the mask with a step within their 3x3; empty where there is none.
cv::Mat steps(const Surface& surface, double step_mm) {
  cv::Mat lowest = surface.depth.clone();
  cv::Mat highest = surface.depth.clone();
  const cv::Mat outside = surface.mask == 0;
  lowest.setTo(kBeyond_mm, outside);
  highest.setTo(-kBeyond_mm, outside);
  const cv::Mat around = cv::Mat::ones(3, 3, CV_8UC1);
  cv::erode(lowest, lowest, around);
  cv::dilate(highest, highest, around);
  const cv::Mat out = (highest - lowest > step_mm) & surface.mask;
  return cv::countNonZero(out) > 0 ? out : cv::Mat();
}

// Connected pieces of `where` that are large enough: labels 1 .. (0: none of them), and how many.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels) {
  cv::Mat all;
  cv::Mat stats;
  cv::Mat centroids;
  const int found = cv::connectedComponentsWithStats(where, all, stats, centroids, 4, CV_32S);
  std::vector<uchar> name(static_cast<std::size_t>(found), 0);
  int count = 0;
  for (int i = 1; i < found; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= smallest_px)
      name[static_cast<std::size_t>(i)] = static_cast<uchar>(++count);
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

// Which of the labelled neighbours of a pixel is nearest to it in depth; 0: none is labelled.
uchar nearestLabel(const Surface& surface, const cv::Mat& labels, const cv::Point& at) {
  const cv::Rect whole(cv::Point(), labels.size());
  uchar nearest = 0;
  float smallest = kBeyond_mm;
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

// Every pixel of the mask gets a label: from its neighbours, ring by ring; what touches none by its
// depth alone.
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

// Of each pair of pieces: pixels along their border, and how many of these are a step.
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

Borders bordersOf(const Surface& surface, const cv::Mat& labels, int count, double step_mm) {
  Borders out;
  out.count = count;
  out.pixels.assign(static_cast<std::size_t>(count * count), 0);
  out.stepping = out.pixels;
  const auto add = [&](const cv::Point& p, const cv::Point& q) {
    const int a = labels.at<uchar>(p);
    const int b = labels.at<uchar>(q);
    if (a == 0 || b == 0 || a == b) return;
    const std::size_t i = out.index(a - 1, b - 1);
    ++out.pixels[i];
    // A step that the sensor has smeared over some pixels is less from one to the next.
    const auto off = double(std::abs(surface.depth.at<float>(p) - surface.depth.at<float>(q)));
    out.stepping[i] += off > 0.5 * step_mm ? 1 : 0;
  };
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      if (u + 1 < labels.cols) add({u, v}, {u + 1, v});
      if (v + 1 < labels.rows) add({u, v}, {u, v + 1});
    }
  }
  return out;
}

// The layer of each piece: one behind the farthest of those that it lies behind. Pieces without a
// step to any other go with the one nearest in depth.
std::vector<int> layersOf(const Borders& borders, const std::vector<double>& depths_mm) {
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

Surface partOf(const Surface& surface, const cv::Mat& mask) {
  const cv::Rect box = cv::boundingRect(mask);
  return {box + surface.box.tl(), mask(box).clone(), surface.depth(box).clone(),
          surface.measured(box) & mask(box), surface.quantum_mm};
}

}  // namespace

Layers findLayers(const Surface& surface, double step_mm) {
  const cv::Mat step = steps(surface, step_mm);
  if (step.empty()) return {};
  const int area = cv::countNonZero(surface.mask);
  // Their number is a byte, whatever the size.
  const int smallest_px = std::max(kSmallest_px, static_cast<int>(kSmallestShare * area));
  Layers out;
  const int pieces = largePieces(surface.mask & ~step, smallest_px, out.labels);
  if (pieces < 2) return {};
  out.labels = grownLabels(surface, pieces, out.labels);
  const std::vector<int> layer = layersOf(bordersOf(surface, out.labels, pieces, step_mm),
                                          meanDepths(surface, out.labels, pieces));
  out.count = *std::max_element(layer.begin(), layer.end()) + 1;
  if (out.count < 2) return {};
  cv::Mat names = cv::Mat::zeros(1, 256, CV_8UC1);
  for (std::size_t i = 0; i < layer.size(); ++i)
    names.at<uchar>(static_cast<int>(i) + 1) = static_cast<uchar>(layer[i] + 1);
  cv::LUT(out.labels, names, out.labels);
  return out;
}

// The last frame's cut, moved with the object.
Layers LayerCutter::carried(const Surface& surface) const {
  if (last_.count < 2) return {};
  const cv::Point2d moved =
      centroidOf(cv::moments(surface.mask, true), surface.box.tl()) - last_centroid_px_;
  const cv::Rect from = last_box_ + cv::Point(cvRound(moved.x), cvRound(moved.y));
  Layers out{last_.count, cv::Mat::zeros(surface.box.size(), CV_8UC1)};
  const cv::Rect common = from & surface.box;
  if (!common.empty())
    last_.labels(common - from.tl()).copyTo(out.labels(common - surface.box.tl()));
  out.labels.setTo(0, surface.mask == 0);
  if (cv::countNonZero(out.labels) == 0) return {};
  out.labels = grownLabels(surface, out.count, out.labels);
  return out;
}

std::vector<Surface> LayerCutter::cut(const Surface& surface, double step_mm) {
  Layers now = findLayers(surface, step_mm * (last_.count > 1 ? kKeptStep : 1.0));
  different_frames_ = now.count == last_.count ? 0 : different_frames_ + 1;
  if (started_ && different_frames_ > 0 && different_frames_ < kFramesToChange)
    now = carried(surface);
  else
    different_frames_ = 0;
  started_ = true;
  // A cut that nothing is left of to carry on is still the one that is held on to.
  if (now.count == last_.count || different_frames_ == 0) {
    last_ = now;
    last_box_ = surface.box;
    last_centroid_px_ = now.count > 1
                            ? centroidOf(cv::moments(surface.mask, true), surface.box.tl())
                            : cv::Point2d();
  }
  if (now.count < 2) return {surface};
  std::vector<Surface> out;
  for (int i = 1; i <= now.count; ++i) out.push_back(partOf(surface, now.labels == i));
  return out;
}

}  // namespace hapticast::server
