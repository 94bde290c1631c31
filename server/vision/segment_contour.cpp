// SPDX-License-Identifier: MIT
#include "server/vision/segment_contour.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/flow.hpp"

namespace hapticast::server {

namespace {

constexpr int kRing_px = 20;  // width of the ring of background around the band
constexpr double kMemory = 0.3;
constexpr double kCoreShare =
    0.8;  // what hangs on at the rim must not teach its colours to the object

struct Local {
  cv::Mat depth;   // mean depth of the neighbourhood, sigma 7 px
  cv::Mat weight;  // how much there was to average, 0..1
  double holes = 0.0;
};

// At half size: the means are smooth.
Local localDepth(const cv::Mat& depth, const cv::Mat& where) {
  cv::Mat known = (depth > 0) & where;
  Local out;
  out.holes = 1.0 - double(cv::countNonZero(known)) / std::max(1, cv::countNonZero(where));
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat weighted = depth.mul(weight);
  cv::resize(weight, weight, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::resize(weighted, weighted, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::GaussianBlur(weight, weight, {}, 3.5, 3.5, cv::BORDER_CONSTANT);
  cv::GaussianBlur(weighted, weighted, {}, 3.5, 3.5, cv::BORDER_CONSTANT);
  cv::Mat mean;
  cv::divide(weighted, weight + 1e-6, mean);
  cv::resize(mean, out.depth, depth.size(), 0, 0, cv::INTER_LINEAR);
  cv::resize(weight, out.weight, depth.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

double depthEvidence(double z, double object, double background, double sigma) {
  const double object_scale = 12 + 3 * sigma;
  const double background_scale = 3 + 3 * sigma;
  const double off_object = std::min(9.0, std::pow((z - object) / object_scale, 2));
  const double off_background = std::min(9.0, std::pow((z - background) / background_scale, 2));
  const double gap = std::abs(object - background) / (2 * object_scale);
  const double clear = 0.25 + 0.75 * std::min(1.0, gap);  // where depths agree, depth keeps silent
  return clear * std::clamp(0.5 * (off_background - off_object), -2.0, 2.0);
}

// D of the notes over the box, for the pixels of `band`.
cv::Mat depthTerm(const cv::Mat& depth, const cv::Mat& band, const cv::Mat& on_planes,
                  const Local& object, const Local& background, const DepthNoise& noise) {
  const double hole =
      std::clamp(std::log((object.holes + 0.02) / (background.holes + 0.02)), -2.0, 2.0);
  cv::Mat out = cv::Mat::zeros(depth.size(), CV_32FC1);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (band.at<unsigned char>(v, u) == 0) continue;
      const auto z = double(depth.at<float>(v, u));
      double evidence = 0.0;
      if (z <= 0) {
        evidence = hole;
      } else if (on_planes.at<unsigned char>(v, u) != 0) {
        evidence = -2.0;
      } else if (object.weight.at<float>(v, u) > 1e-3F &&
                 background.weight.at<float>(v, u) > 1e-3F) {
        evidence = depthEvidence(z, double(object.depth.at<float>(v, u)),
                                 double(background.depth.at<float>(v, u)), noise.at(z));
      } else if (object.weight.at<float>(v, u) > 1e-3F) {
        // A background without depth: being near the object's depth speaks for it, by as much as
        // holes are rare in it.
        const double off =
            std::abs(z - double(object.depth.at<float>(v, u))) / (12 + 3 * noise.at(z));
        evidence = off < 2.0 ? -hole : -1.0;
      }
      out.at<float>(v, u) = static_cast<float>(evidence);
    }
  }
  return out;
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

cv::Mat signedDistance(const cv::Mat& mask) {
  cv::Mat inside;
  cv::Mat outside;
  cv::distanceTransform(mask, inside, cv::DIST_L2, 3);
  cv::distanceTransform(mask == 0, outside, cv::DIST_L2, 3);
  return inside - outside;
}

// Guided filter: puts the zero line of `values` on the edges of `gray`.
cv::Mat guided(const cv::Mat& gray, const cv::Mat& values) {
  constexpr double kEps = 8e-4;
  const cv::Size window(9, 9);
  cv::Mat guide;
  gray.convertTo(guide, CV_32F, 1.0 / 255.0);
  const auto mean = [&](const cv::Mat& m) {
    cv::Mat out;
    cv::boxFilter(m, out, CV_32F, window);
    return out;
  };
  const cv::Mat mean_guide = mean(guide);
  const cv::Mat mean_values = mean(values);
  const cv::Mat variance = mean(guide.mul(guide)) - mean_guide.mul(mean_guide);
  const cv::Mat covariance = mean(guide.mul(values)) - mean_guide.mul(mean_values);
  cv::Mat slope;
  cv::divide(covariance, variance + kEps, slope);
  const cv::Mat offset = mean_values - slope.mul(mean_guide);
  return mean(slope).mul(guide) + mean(offset);
}

// The largest piece, and others over a tenth of it that the carried mask supports.
cv::Mat mainPieces(const cv::Mat& mask, const cv::Mat& carried) {
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  std::vector<int> overlap(static_cast<std::size_t>(count), 0);
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (carried.at<unsigned char>(v, u) != 0)
        ++overlap[static_cast<std::size_t>(labels.at<int>(v, u))];
    }
  }
  int largest = 0;
  for (int i = 1; i < count; ++i) largest = std::max(largest, stats.at<int>(i, cv::CC_STAT_AREA));
  cv::Mat out = cv::Mat::zeros(mask.size(), CV_8UC1);
  for (int i = 1; i < count; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    const bool supported =
        area > 0.1 * largest && overlap[static_cast<std::size_t>(i)] > 0.6 * area;
    if (area == largest || supported) out |= labels == i;
  }
  return out;
}

}  // namespace

ContourResult decideContour(const View& view, const cv::Mat& carried, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory) {
  ContourResult result{cv::Mat::zeros(carried.size(), CV_8UC1), 0.0};
  const cv::Rect box = boxAround(carried, kBand_px + kRing_px);
  if (box.empty()) return result;
  const cv::Mat last = carried(box);
  const cv::Mat distance = signedDistance(last);
  const cv::Mat core = distance > kBand_px;
  const cv::Mat band = (distance > -kBand_px) & (core == 0);
  const cv::Mat depth = view.depth(box);
  const cv::Mat color =
      colorTerm(view.color(box), colorEvidence(memory.first, memory.now, memory.background));
  const cv::Mat depth_evidence =
      depthTerm(depth, band, onPlanes(view.depth, box, planes), localDepth(depth, distance > 3),
                localDepth(depth, distance < -kBand_px), noise);
  cv::Mat seen = 1.5 * color + depth_evidence;
  cv::blur(seen, seen, {3, 3});
  cv::Mat prior;
  cv::max(cv::min(distance / kBand_px, 1.0), -1.0, prior);
  cv::Mat evidence = seen + 1.2 * prior;
  if (!memory.evidence.empty()) {
    const cv::Mat before = carryImage(memory.evidence, memory.box, box,
                                      cv::Matx23d(1, 0, 0, 0, 1, 0), cv::INTER_NEAREST);
    evidence = (1 - kMemory) * evidence + kMemory * before;
  }
  evidence.setTo(3.0, core);
  evidence.setTo(-3.0, distance <= -kBand_px);
  cv::max(cv::min(evidence, 3.0), -3.0, evidence);
  cv::Mat mask = (guided(view.gray(box), evidence) > 0) & (distance > -kBand_px);
  mask |= core;
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3}));
  mask = mainPieces(mask, last);
  fillHoles(mask, 400);
  mask.copyTo(result.mask(box));
  result.inside_color = cv::mean(color, mask)[0];
  memory.evidence = evidence;
  memory.box = box;
  return result;
}

void learn(const View& view, const cv::Mat& mask, ContourMemory& memory) {
  const cv::Rect box = boxAround(mask, kBand_px + kRing_px);
  if (box.empty()) return;
  const cv::Mat inside = mask(box);
  const cv::Mat color = view.color(box);
  ColorHistogram object = ColorHistogram::of(color, inside);
  object.adapt(ColorHistogram::of(color, erodedBy(inside, kBand_px)), kCoreShare);
  const cv::Mat ring = dilatedBy(inside, kBand_px + kRing_px) & (dilatedBy(inside, kBand_px) == 0);
  if (memory.first.empty()) memory.first = object;
  memory.now.adapt(object, 0.1);
  memory.background.adapt(ColorHistogram::of(color, ring), 0.2);
}

}  // namespace hapticast::server
