// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/contour.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/segment/rules.hpp"

namespace hapticast::server {

namespace {

// Weights and limits of the sum in README.md: tuned on nine synthetic scenes through four sensors
// and checked on real captures, unless marked.
constexpr float kMemory = 0.3F;  // of the last decision; 0 is sharper, but flickers more
constexpr float kLimit = 3.0F;   // of the evidence
// Limit of the depth's evidence; a larger one includes touching hands.
constexpr double kMostDepth = 2.0;
// Weight of the core, so that background at the rim does not enter the colours.
constexpr double kCoreShare = 0.8;
constexpr int kCell_px = 4;         // chosen for time: a mean over sigma 7 px is smooth
constexpr float kInside_px = 3.0F;  // chosen: depth nearer to the contour is not reliable
constexpr int kLargestHole_px = 400;
// Of the largest: the end of an object that sticks out of a hand.
constexpr double kLeastPart = 0.03;
constexpr double kColorWeight = 1.5;
// Tuned on drawn scenes: with 2 an object that returns stays partial, with 0 hands join the mask.
constexpr double kShapeWeight = 1.2;
constexpr double kShapeShare = 1.0 / 30.0;  // chosen: the shape is the mean of about a second
constexpr double kWholePicture = 0.3;  // of the background, if the object differs from the picture
constexpr double kUnlike = 0.35;  // distance of two histograms at which colour has its full weight
constexpr double kLeastColor = 0.6;
constexpr double kGuidedEps = 2e-3;
// Mixed colours at the contour resemble unseen colours and count as background. Without this offset
// masks are a third of a pixel too small. It needs evidence, so that a doubtful contour does not
// creep.
constexpr float kLean = 0.3F;
constexpr float kClear = 2.0F;

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
  // Returns whether there are enough depths for a mean.
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
  const double clear = 0.25 + 0.75 * std::min(1.0, gap);  // equal depths yield no evidence
  const double squares = off_background * off_background - off_object * off_object;
  return clear * std::clamp(0.5 * squares, -kMostDepth, kMostDepth);
}

// Mean depths beside a contour, and the evidence of a pixel without depth there.
struct BesideContour {
  Local object, background;
  double hole = 0.0;  // log ratio of the shares of holes, object to background

  explicit BesideContour(const ObjectRoi& patch)
      : object(patch.depth.size()), background(patch.depth.size()) {
    for (int v = 0; v < patch.depth.rows; ++v) {
      const auto* z = patch.depth.ptr<float>(v);
      const auto* d = patch.distance.ptr<float>(v);
      for (int u = v % 2; u < patch.depth.cols; u += 2) {
        if (d[u] > kInside_px) {
          object.add(v, u, z[u]);
        } else if (d[u] < -kBand_px) {
          background.add(v, u, z[u]);
        }
      }
    }
    object.settle();
    background.settle();
    hole = std::clamp(std::log((object.holes() + 0.02) / (background.holes() + 0.02)), -kMostDepth,
                      kMostDepth);
  }

  [[nodiscard]] double evidence(int v, int u, double z, const DepthNoise& noise) const {
    if (z <= 0) return hole;
    if (!object.knows(v, u)) return 0.0;
    if (background.knows(v, u))
      return depthEvidence(z, object.at(v, u), background.at(v, u), noise.at(z));
    // The background has no depth: a depth near the object's is evidence for the object, more so if
    // the object has few holes.
    const double off = std::abs(z - object.at(v, u)) / (12 + 3 * noise.at(z));
    return off < 2.0 ? -hole : -1.0;
  }
};

// Returns 255 in the band where depth excludes the object: on planes, where something hides it, and
// where it would be too far.
cv::Mat findExcluded(const ObjectRoi& patch, const std::vector<Plane>& planes) {
  cv::Mat out = findBandOnPlanes(patch, planes);
  if (!patch.farther.empty()) out |= patch.farther;
  out &= patch.depth > 0;
  if (!patch.nearer.empty()) out |= patch.nearer;
  return out;
}

// Returns the depth's evidence for the pixels of the band; 0 elsewhere.
cv::Mat depthTerm(const ObjectRoi& patch, const cv::Mat& excluded, const DepthNoise& noise) {
  const BesideContour beside(patch);
  cv::Mat out = cv::Mat::zeros(patch.depth.size(), CV_32FC1);
  for (int v = 0; v < out.rows; ++v) {
    const auto* z = patch.depth.ptr<float>(v);
    const auto* d = patch.distance.ptr<float>(v);
    const auto* is_excluded = excluded.ptr<unsigned char>(v);
    auto* to = out.ptr<float>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (d[u] <= -kBand_px || d[u] > kBand_px) continue;
      to[u] = static_cast<float>(is_excluded[u] != 0 ? -kMostDepth
                                                     : beside.evidence(v, u, double(z[u]), noise));
    }
  }
  return out;
}

// Adds the priors: distance to the old contour, and the last decision (`before`, may be empty).
void addExpectation(const cv::Mat& distance, const cv::Mat& before, cv::Mat& evidence) {
  for (int v = 0; v < evidence.rows; ++v) {
    const auto* d = distance.ptr<float>(v);
    const auto* last = before.empty() ? nullptr : before.ptr<float>(v);
    auto* to = evidence.ptr<float>(v);
    for (int u = 0; u < evidence.cols; ++u) {
      float value = to[u] + 2.0F * std::clamp(d[u] / kBand_px, -1.0F, 1.0F);
      if (last != nullptr) value = (1 - kMemory) * value + kMemory * last[u];
      value = std::clamp(value, -kLimit, kLimit);
      to[u] = d[u] > kBand_px ? kLimit : d[u] <= -kBand_px ? -kLimit : value;
    }
  }
}

cv::Mat boxMean(const cv::Mat& image) {
  cv::Mat out;
  cv::boxFilter(image, out, CV_32F, {3, 3});
  return out;
}

// Returns 255 where slope x grey + offset is above 0 in the band, or a pixel lies deeper inside;
// over the patch's box at full size.
cv::Mat applyThreshold(const ObjectRoi& patch, const cv::Mat& slope, const cv::Mat& offset) {
  cv::Mat out(patch.gray.size(), CV_8UC1);
  for (int v = 0; v < out.rows; ++v) {
    const auto* g = patch.gray.ptr<unsigned char>(v);
    const auto* a = slope.ptr<float>(v);
    const auto* b = offset.ptr<float>(v);
    const auto* d = patch.distance.ptr<float>(v / patch.factor);
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < out.cols; ++u) {
      const float depth = d[u / patch.factor];
      const bool inside = a[u] * static_cast<float>(g[u]) + b[u] > 0;
      to[u] = depth > kBand_px || (inside && depth > -kBand_px) ? 255 : 0;
    }
  }
  return out;
}

// Guided filter (He, Sun and Tang 2010): aligns the zero line of the evidence with edges of the
// picture. Slopes and offsets are computed at half size or less (boxes of 3 x 3 there); the guide
// has full size. Returns 255 where the result is above 0, over the patch's box at full size.
cv::Mat filterGuided(const ObjectRoi& patch, const cv::Mat& evidence, float lean) {
  cv::Mat values = evidence + lean * cv::min(cv::abs(evidence) * (1.0F / kClear), 1.0F);
  const int factor = std::max(2, patch.factor);
  const cv::Size size((patch.gray.cols + factor - 1) / factor,
                      (patch.gray.rows + factor - 1) / factor);
  cv::Mat guide;
  cv::resize(patch.gray, guide, size, 0, 0, cv::INTER_AREA);
  if (factor > patch.factor) cv::resize(values, values, size, 0, 0, cv::INTER_AREA);
  guide.convertTo(guide, CV_32F, 1.0 / 255.0);
  const cv::Mat mean_guide = boxMean(guide);
  const cv::Mat mean_values = boxMean(values);
  const cv::Mat variance = boxMean(guide.mul(guide)) - mean_guide.mul(mean_guide);
  const cv::Mat covariance = boxMean(guide.mul(values)) - mean_guide.mul(mean_values);
  cv::Mat slope;
  cv::divide(covariance, variance + kGuidedEps, slope);
  cv::Mat offset = boxMean(mean_values - slope.mul(mean_guide));
  slope = boxMean(slope) * (1.0 / 255.0);
  cv::resize(slope, slope, patch.gray.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(offset, offset, patch.gray.size(), 0, 0, cv::INTER_LINEAR);
  return applyThreshold(patch, slope, offset);
}

// Removes pieces other than the largest, unless they are large enough and lie in the expected mask.
// Fills small holes.
void keepMainPieces(cv::Mat& mask, const ObjectRoi& patch) {
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
  cv::Mat expected;
  const auto supported = [&](std::size_t i) {
    if (expected.empty()) expected = scaleToFullSize(patch.inside, patch);
    const cv::Rect box = cv::boundingRect(contours[i]);
    cv::Mat piece = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::drawContours(piece, contours, int(i), 255, cv::FILLED, cv::LINE_8, {}, 0, -box.tl());
    return cv::countNonZero(piece & expected(box)) > 0.6 * cv::countNonZero(piece);
  };
  for (std::size_t i = 0; i < contours.size(); ++i) {
    const bool hole = tree[i][3] >= 0;
    if (hole && area[i] < kLargestHole_px)
      cv::drawContours(mask, contours, int(i), 255, cv::FILLED);
    if (!hole && area[i] < largest && (area[i] <= kLeastPart * largest || !supported(i)))
      cv::drawContours(mask, contours, int(i), 0, cv::FILLED);
  }
}

}  // namespace

void warpEvidence(ContourMemory& memory, const ObjectRoi& patch, const cv::Matx23d& similarity) {
  if (patch.empty()) return;
  for (cv::Mat* image : {&memory.evidence, &memory.shape}) {
    if (!image->empty()) *image = warpPatch(*image, memory.to_picture, patch, similarity);
  }
  memory.to_picture = patch.toPicture();
}

void ContourMemory::forgetPlace() {
  evidence.release();
  shape.release();
}

std::vector<float> computeColorEvidence(const ContourMemory& memory) {
  ColorHistogram background = memory.background;
  background.adapt(memory.elsewhere,
                   kWholePicture * (1.0 - computeOverlap(memory.first, memory.elsewhere)));
  // Colours that the object shares with negative samples or the hand cannot separate the two.
  for (const ColorHistogram* others : {&memory.avoided, &memory.hand}) {
    const double other = 1.0 - computeOverlap(memory.first, *others);
    background.raise(*others, std::min(1.0, other / kUnlike), memory.first);
  }
  return colorEvidence(memory.first, memory.now, background);
}

ContourResult decideContour(const ObjectRoi& patch, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory) {
  ContourResult result;
  const cv::Mat color = mapEvidence(patch.color, computeColorEvidence(memory));
  // If object and background have similar colours, depth decides.
  const double unlike = 1.0 - computeOverlap(memory.first, memory.background);
  const double color_weight = kColorWeight * std::clamp(unlike / kUnlike, kLeastColor, 1.0);
  const cv::Mat excluded = findExcluded(patch, planes);
  cv::Mat evidence = color_weight * color + depthTerm(patch, excluded, noise);
  cv::blur(evidence, evidence, {3, 3});
  // What hides the object is no part of it, whatever its shape.
  const cv::Mat not_hidden = patch.nearer.empty() ? cv::Mat() : cv::Mat(~patch.nearer);
  if (!memory.shape.empty() && usesRule(Rule::kShape))
    cv::add(evidence, kShapeWeight * memory.shape, evidence, not_hidden);
  addExpectation(patch.distance, memory.evidence, evidence);
  // The first frame must not creep either.
  const float lean = memory.evidence.empty() || !usesRule(Rule::kLean) ? 0.0F : kLean;
  result.mask = filterGuided(patch, evidence, lean);
  cv::morphologyEx(result.mask, result.mask, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  keepMainPieces(result.mask, patch);
  result.inside_color = cv::mean(color, scaleToPatchSize(result.mask, patch))[0];
  memory.evidence = evidence;
  memory.to_picture = patch.toPicture();
  return result;
}

void updateShape(const ObjectRoi& patch, const cv::Mat& mask, bool is_whole,
                 ContourMemory& memory) {
  cv::Mat now;
  const double outside = is_whole ? -1.0 : 0.0;
  scaleToPatchSize(mask, patch).convertTo(now, CV_32F, (1.0 - outside) / 255.0, outside);
  if (memory.shape.empty()) {
    memory.shape = now;
    memory.to_picture = patch.toPicture();
    return;
  }
  cv::Mat next = (1.0 - kShapeShare) * memory.shape + kShapeShare * now;
  if (!patch.hidden.empty()) memory.shape.copyTo(next, patch.hidden);
  memory.shape = next;
}

void updateMemory(const ObjectRoi& patch, const cv::Mat& mask, ContourMemory& memory) {
  const cv::Mat inside = scaleToPatchSize(mask, patch);
  ColorHistogram object;
  ColorHistogram core;
  ColorHistogram ring;
  for (int v = 0; v < inside.rows; ++v) {
    const auto* color = patch.color.ptr<cv::Vec3b>(v);
    const auto* in = inside.ptr<unsigned char>(v);
    const auto* d = patch.distance.ptr<float>(v);
    for (int u = 0; u < inside.cols; ++u) {
      if (in[u] != 0) {
        object.count(color[u]);
        if (d[u] > kBand_px) core.count(color[u]);
      } else if (d[u] < -kBand_px && d[u] >= -(kBand_px + kRing_px)) {
        ring.count(color[u]);
      }
    }
  }
  for (ColorHistogram* histogram : {&object, &core, &ring}) histogram->finish();
  object.adapt(core, kCoreShare);
  if (memory.first.empty()) memory.first = object;
  memory.now.adapt(object, 0.1);
  memory.background.adapt(ring, 0.2);
}

}  // namespace hapticast::server
