// SPDX-License-Identifier: MIT
#include "server/vision/segment_contour.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr int kRing_px = 20;  // width of the ring of background around the band
constexpr float kMemory = 0.3F;
constexpr float kLimit = 3.0F;  // of the evidence
constexpr double kCoreShare =
    0.8;  // what hangs on at the rim must not teach its colours to the object
constexpr int kCell_px = 4;
constexpr int kLargestHole_px = 400;
constexpr int kDenseLearning_px = 60000;  // larger boxes teach by every second pixel and row

// Mean depth of the neighbourhood (sigma 7 px) in cells of kCell_px: it is smooth.
struct Local {
  cv::Mat sum, weight, mean;
  int known = 0, seen = 0;

  explicit Local(const cv::Size& size)
      : sum(cv::Mat::zeros((size.height + kCell_px - 1) / kCell_px,
                           (size.width + kCell_px - 1) / kCell_px, CV_32FC1)),
        weight(cv::Mat::zeros(sum.size(), CV_32FC1)) {}
  void add(int v, int u, float z) {
    ++seen;
    if (z <= 0.0F) return;
    ++known;
    sum.at<float>(v / kCell_px, u / kCell_px) += z;
    weight.at<float>(v / kCell_px, u / kCell_px) += 1.0F;
  }
  void settle() {
    const double sigma = 7.0 / kCell_px;
    cv::GaussianBlur(weight, weight, {}, sigma, sigma, cv::BORDER_CONSTANT);
    cv::GaussianBlur(sum, sum, {}, sigma, sigma, cv::BORDER_CONSTANT);
    cv::divide(sum, weight + 1e-6, mean);
  }
  [[nodiscard]] double holes() const { return 1.0 - double(known) / std::max(1, seen); }
  // Whether there was enough to average.
  [[nodiscard]] bool knows(int v, int u) const {
    return weight.at<float>(v / kCell_px, u / kCell_px) > 1e-3F * kCell_px * kCell_px;
  }
  [[nodiscard]] double at(int v, int u) const {
    return double(mean.at<float>(v / kCell_px, u / kCell_px));
  }
};

double depthEvidence(double z, double object, double background, double sigma) {
  const double object_scale = 12 + 3 * sigma;
  const double background_scale = 3 + 3 * sigma;
  const double off_object = std::min(3.0, std::abs(z - object) / object_scale);
  const double off_background = std::min(3.0, std::abs(z - background) / background_scale);
  const double gap = std::abs(object - background) / (2 * object_scale);
  const double clear = 0.25 + 0.75 * std::min(1.0, gap);  // where depths agree, depth keeps silent
  const double squares = off_background * off_background - off_object * off_object;
  return clear * std::clamp(0.5 * squares, -2.0, 2.0);
}

// D of the notes, for the pixels of the band; added to `evidence`.
void addDepthTerm(const cv::Mat& depth, const cv::Mat& distance, const cv::Mat& on_planes,
                  const DepthNoise& noise, cv::Mat& evidence) {
  Local object(depth.size());
  Local background(depth.size());
  for (int v = 0; v < depth.rows; ++v) {
    const auto* z = depth.ptr<float>(v);
    const auto* d = distance.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (d[u] > 3) {
        object.add(v, u, z[u]);
      } else if (d[u] < -kBand_px) {
        background.add(v, u, z[u]);
      }
    }
  }
  object.settle();
  background.settle();
  const double hole =
      std::clamp(std::log((object.holes() + 0.02) / (background.holes() + 0.02)), -2.0, 2.0);
  const auto evidenceOf = [&](int v, int u, double z) {
    if (z <= 0) return hole;
    if (on_planes.at<unsigned char>(v, u) != 0) return -2.0;
    if (!object.knows(v, u)) return 0.0;
    if (background.knows(v, u))
      return depthEvidence(z, object.at(v, u), background.at(v, u), noise.at(z));
    // A background without depth: being near the object's depth speaks for it, by as much as holes
    // are rare in it.
    const double off = std::abs(z - object.at(v, u)) / (12 + 3 * noise.at(z));
    return off < 2.0 ? -hole : -1.0;
  };
  for (int v = 0; v < depth.rows; ++v) {
    const auto* z = depth.ptr<float>(v);
    const auto* d = distance.ptr<float>(v);
    auto* to = evidence.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (d[u] > -kBand_px && d[u] <= kBand_px)
        to[u] += static_cast<float>(evidenceOf(v, u, double(z[u])));
    }
  }
}

cv::Mat colorTerm(const cv::Mat& color, const std::vector<float>& evidence) {
  cv::Mat out(color.size(), CV_32FC1);
  for (int v = 0; v < color.rows; ++v) {
    const auto* in = color.ptr<cv::Vec3b>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; u < color.cols; ++u) to[u] = evidence[ColorHistogram::binOf(in[u])];
  }
  return out;
}

// The last decision over another box; 0 where there was none.
cv::Mat shifted(const cv::Mat& image, const cv::Rect& from, const cv::Rect& to) {
  if (image.empty() || from == to) return image;
  cv::Mat out = cv::Mat::zeros(to.size(), image.type());
  const cv::Rect common = from & to;
  if (!common.empty()) image(common - from.tl()).copyTo(out(common - to.tl()));
  return out;
}

// What was seen with what is expected: near the old contour, and like the last decision (`before`,
// may be empty).
void addExpectation(const cv::Mat& distance, const cv::Mat& before, cv::Mat& evidence) {
  for (int v = 0; v < evidence.rows; ++v) {
    const auto* d = distance.ptr<float>(v);
    const auto* last = before.empty() ? nullptr : before.ptr<float>(v);
    auto* to = evidence.ptr<float>(v);
    for (int u = 0; u < evidence.cols; ++u) {
      float value = to[u] + 1.2F * std::clamp(d[u] / kBand_px, -1.0F, 1.0F);
      if (last != nullptr) value = (1 - kMemory) * value + kMemory * last[u];
      value = std::clamp(value, -kLimit, kLimit);
      to[u] = d[u] > kBand_px ? kLimit : d[u] <= -kBand_px ? -kLimit : value;
    }
  }
}

// Guided filter (radius 4), which puts the zero line of `values` on the edges of `gray`: its slopes
// and offsets are smooth and found at half size, its guide is whole. 255 where it is above 0.
cv::Mat guided(const cv::Mat& gray, const cv::Mat& values, const cv::Mat& distance) {
  constexpr double kEps = 8e-4;
  const cv::Size half((gray.cols + 1) / 2, (gray.rows + 1) / 2);
  cv::Mat guide;
  cv::Mat small;
  cv::resize(gray, guide, half, 0, 0, cv::INTER_AREA);
  cv::resize(values, small, half, 0, 0, cv::INTER_AREA);
  guide.convertTo(guide, CV_32F, 1.0 / 255.0);
  const auto mean = [](const cv::Mat& m) {
    cv::Mat out;
    cv::boxFilter(m, out, CV_32F, {5, 5});
    return out;
  };
  const cv::Mat mean_guide = mean(guide);
  const cv::Mat mean_values = mean(small);
  const cv::Mat variance = mean(guide.mul(guide)) - mean_guide.mul(mean_guide);
  const cv::Mat covariance = mean(guide.mul(small)) - mean_guide.mul(mean_values);
  cv::Mat slope;
  cv::divide(covariance, variance + kEps, slope);
  cv::Mat offset = mean(mean_values - slope.mul(mean_guide));
  slope = mean(slope) * (1.0 / 255.0);
  cv::resize(slope, slope, gray.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(offset, offset, gray.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out(gray.size(), CV_8UC1);
  for (int v = 0; v < out.rows; ++v) {
    const auto* g = gray.ptr<unsigned char>(v);
    const auto* a = slope.ptr<float>(v);
    const auto* b = offset.ptr<float>(v);
    const auto* d = distance.ptr<float>(v);
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < out.cols; ++u) {
      const bool inside = a[u] * static_cast<float>(g[u]) + b[u] > 0;
      to[u] = d[u] > kBand_px || (inside && d[u] > -kBand_px) ? 255 : 0;
    }
  }
  return out;
}

// Keeps the largest piece, and others over a tenth of it that the carried mask supports; fills
// small holes.
void keepMainPieces(cv::Mat& mask, const cv::Mat& carried) {
  std::vector<std::vector<cv::Point>> contours;
  std::vector<cv::Vec4i> tree;
  cv::findContours(mask, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  std::vector<double> area(contours.size());
  double largest = 0;
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const bool hole = tree[i][3] >= 0;
    area[i] = cv::contourArea(contours[i]);
    if (!hole) largest = std::max(largest, area[i]);
  }
  const auto supported = [&](std::size_t i) {
    const cv::Rect box = cv::boundingRect(contours[i]);
    cv::Mat piece = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::drawContours(piece, contours, int(i), 255, cv::FILLED, cv::LINE_8, {}, 0, -box.tl());
    return cv::countNonZero(piece & carried(box)) > 0.6 * cv::countNonZero(piece);
  };
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const bool hole = tree[i][3] >= 0;
    if (hole && area[i] < kLargestHole_px)
      cv::drawContours(mask, contours, int(i), 255, cv::FILLED);
    if (!hole && area[i] < largest && (area[i] <= 0.1 * largest || !supported(i)))
      cv::drawContours(mask, contours, int(i), 0, cv::FILLED);
  }
}

}  // namespace

ContourRegion contourRegion(const cv::Mat& mask) {
  ContourRegion out{boxAround(mask, kBand_px + kRing_px), {}};
  if (out.box.empty()) return out;
  // One transform for both sides: the distance to the outermost pixels inside.
  const cv::Mat inside = mask(out.box);
  cv::Mat inner;
  cv::erode(inside, inner, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  cv::distanceTransform((inside == 0) | inner, out.distance, cv::DIST_L2, 3);
  for (int v = 0; v < inside.rows; ++v) {
    const auto* in = inside.ptr<unsigned char>(v);
    auto* d = out.distance.ptr<float>(v);
    for (int u = 0; u < inside.cols; ++u) d[u] = in[u] != 0 ? d[u] + 1.0F : -d[u];
  }
  return out;
}

ContourResult decideContour(const View& view, const cv::Mat& carried, const ContourRegion& region,
                            const DepthNoise& noise, const std::vector<Plane>& planes,
                            ContourMemory& memory) {
  ContourResult result{cv::Mat::zeros(carried.size(), CV_8UC1), 0.0};
  const cv::Rect& box = region.box;
  if (box.empty()) return result;
  const cv::Mat color =
      colorTerm(view.color(box), colorEvidence(memory.first, memory.now, memory.background));
  cv::Mat evidence = 1.5 * color;
  addDepthTerm(view.depth(box), region.distance, onPlanes(view.depth, box, planes), noise,
               evidence);
  cv::blur(evidence, evidence, {3, 3});
  addExpectation(region.distance, shifted(memory.evidence, memory.box, box), evidence);
  cv::Mat mask = guided(view.gray(box), evidence, region.distance);
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  keepMainPieces(mask, carried(box));
  mask.copyTo(result.mask(box));
  result.inside_color = cv::mean(color, mask)[0];
  memory.evidence = evidence;
  memory.box = box;
  return result;
}

void learn(const View& view, const cv::Mat& mask, const ContourRegion& region,
           ContourMemory& memory) {
  const cv::Rect& box = region.box;
  ColorHistogram object;
  ColorHistogram core;
  ColorHistogram ring;
  const int step = box.area() > kDenseLearning_px ? 2 : 1;
  for (int v = 0; v < box.height; v += step) {
    const auto* color = view.color.ptr<cv::Vec3b>(v + box.y) + box.x;
    const auto* inside = mask.ptr<unsigned char>(v + box.y) + box.x;
    const auto* d = region.distance.ptr<float>(v);
    for (int u = 0; u < box.width; u += step) {
      if (inside[u] != 0) {
        object.count(color[u]);
        if (d[u] > kBand_px) core.count(color[u]);
      } else if (d[u] < -kBand_px && d[u] >= -(kBand_px + kRing_px)) {
        ring.count(color[u]);
      }
    }
  }
  for (ColorHistogram* histogram : {&object, &core, &ring}) histogram->settle();
  object.adapt(core, kCoreShare);
  if (memory.first.empty()) memory.first = object;
  memory.now.adapt(object, 0.1);
  memory.background.adapt(ring, 0.2);
}

}  // namespace hapticast::server
