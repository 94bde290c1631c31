// SPDX-License-Identifier: MIT
#include "server/vision/base/depth_scale_alignment.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/reduction.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// Chosen, in a usual picture: its 19200 samples suffice. Larger pictures have as many.
constexpr int kEvery_px = 4;
constexpr float kSameGray = 9.0F;          // chosen, levels: above a camera's noise over 4 x 4 px
constexpr double kRestingShare = 0.7;      // chosen, of the samples: with less the camera moves
constexpr std::size_t kFewestPairs = 300;  // chosen
constexpr int kAsWide_px = 12;  // chosen, in a usual picture: depth is mixed around objects
// Chosen: an estimator's scale varies by 1 to 5 %, a sensor's by less than a thousandth.
constexpr double kHop = 0.004;
// A hop of the whole picture at rest: only an estimator causes it.
constexpr double kLargeHop = 0.015;
constexpr int kEnoughHops = 3;     // in alternating directions
constexpr double kExplains = 0.5;  // chosen: a hop has to remove this share of the deviation
constexpr float kLongest = 16.0F;  // frames of the average over resting samples
constexpr int kFirstLook = 25;     // frames that are all examined; after them every eighth
constexpr int kLookEvery = 8;
constexpr int kTries = 60;            // of two samples each: 1e-4 that no try is of the background
constexpr std::size_t kJudges = 400;  // samples that judge a try
constexpr int kRounds = 5;            // of reweighting; measured: converged by then
constexpr double kNearlyNone = 0.05;  // of 1/z: smaller values lie behind the farthest depth
constexpr double kTukey = 4.685;      // Beaton and Tukey 1974

ScaleShift fitScaleShift(const auto& a, const auto& b) {
  const double along = b.now - a.now;
  if (std::abs(along) < 1e-9) return {};
  const double scale = (b.before - a.before) / along;
  return {scale, a.before - scale * a.now};
}

double computeMedianError(const auto& pairs, std::size_t step, const ScaleShift& hop) {
  std::vector<double> offs;
  offs.reserve(pairs.size() / step + 1);
  for (std::size_t i = 0; i < pairs.size(); i += step)
    offs.push_back(std::abs(hop.scale * pairs[i].now + hop.shift - pairs[i].before));
  return computeMedian(offs);
}

// Iteratively reweighted least squares with Tukey's biweight: outliers have weight 0.
ScaleShift refineFit(const auto& pairs, ScaleShift hop) {
  for (int round = 0; round < kRounds; ++round) {
    const double limit = kTukey * 1.48 * computeMedianError(pairs, 1, hop) + 1e-9;
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const auto& pair : pairs) {
      const double off = (hop.scale * pair.now + hop.shift - pair.before) / limit;
      if (std::abs(off) >= 1.0) continue;
      const double weight = (1 - off * off) * (1 - off * off);
      w += weight;
      x += weight * pair.now;
      y += weight * pair.before;
      xx += weight * pair.now * pair.now;
      xy += weight * pair.now * pair.before;
    }
    const double spread = w * xx - x * x;
    // At equal depths only a shift can be estimated.
    if (w <= 0) return hop;
    hop.scale = spread > 1e-6 * xx * w ? (w * xy - x * y) / spread : 1.0;
    hop.shift = (y - hop.scale * x) / w;
  }
  return hop;
}

// Least median of squares (Rousseeuw 1984), then refined.
ScaleShift estimateShift(const auto& pairs) {
  const std::size_t step = pairs.size() / kJudges + 1;
  ScaleShift best;
  double least = computeMedianError(pairs, step, best);
  std::minstd_rand random(1);
  for (int i = 0; i < kTries; ++i) {
    const ScaleShift hop =
        fitScaleShift(pairs[random() % pairs.size()], pairs[random() % pairs.size()]);
    if (!(hop.scale > 0.5 && hop.scale < 2.0)) continue;
    const double off = computeMedianError(pairs, step, hop);
    if (off >= least) continue;
    least = off;
    best = hop;
  }
  return refineFit(pairs, best);
}

// Samples the brightness as means of `every_px` x `every_px`, and the depth in their middle.
cv::Mat sparseGray(const cv::Mat& gray, int every_px) {
  cv::Mat out;
  cv::resize(gray, out, {gray.cols / every_px, gray.rows / every_px}, 0, 0, cv::INTER_AREA);
  out.convertTo(out, CV_32F);
  return out;
}

cv::Mat sparse(const cv::Mat& image, int every_px) {
  if (every_px == 1) return image;
  cv::Mat out;
  cv::resize(image, out, {image.cols / every_px, image.rows / every_px}, 0, 0, cv::INTER_NEAREST);
  return out;
}

// Returns 255 at the samples on or beside an object. The dilation works at the usual size and only
// around the objects.
cv::Mat cutAroundObjects(const cv::Mat& objects, int factor) {
  const cv::Mat usual = sparse(objects, factor);
  const cv::Rect box = findBoxAround(usual, kAsWide_px + 1);
  cv::Mat out = cv::Mat::zeros(usual.size(), CV_8UC1);
  if (!box.empty()) dilateBy(usual(box), kAsWide_px).copyTo(out(box));
  return sparse(out, kEvery_px);
}

// Estimates a change of exposure as the median gain of all samples.
float estimateGain(const cv::Mat& now, const cv::Mat& before) {
  std::vector<float> gains;
  gains.reserve(now.total());
  for (int v = 0; v < now.rows; ++v) {
    for (int u = 0; u < now.cols; ++u) {
      const float was = before.at<float>(v, u);
      if (was > 8.0F) gains.push_back(now.at<float>(v, u) / was);
    }
  }
  return gains.empty() ? 1.0F : static_cast<float>(std::clamp(computeMedian(gains), 0.5, 2.0));
}

}  // namespace

// Returns the depths, now and before, of background samples with unchanged brightness.
std::vector<DepthScaleAlignment::Pair> DepthScaleAlignment::restingPairs(const cv::Mat& depth,
                                                                         const cv::Mat& gray,
                                                                         const cv::Mat& objects) {
  const float gain = estimateGain(gray, gray_);
  std::vector<Pair> pairs;
  pairs.reserve(depth.total());
  std::size_t background = 0;
  std::size_t resting = 0;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (!objects.empty() && objects.at<uchar>(v, u) != 0) continue;
      ++background;
      const bool rests = std::abs(gray.at<float>(v, u) - gain * gray_.at<float>(v, u)) <= kSameGray;
      if (!rests) {
        age_.at<float>(v, u) = 0.0F;
        continue;
      }
      ++resting;
      const float now = depth.at<float>(v, u);
      const float before = depth_.at<float>(v, u);
      if (now > 0 && before > 0) pairs.push_back({toAligned(now), toAligned(before)});
    }
  }
  camera_rests_ = static_cast<double>(resting) >= kRestingShare * static_cast<double>(background);
  return pairs;
}

// Decides whether the source hops: all resting samples alternate, or jump far at once.
void DepthScaleAlignment::judge(const std::vector<Pair>& pairs, const ScaleShift& hop) {
  std::vector<double> values;
  values.reserve(pairs.size());
  for (const Pair& pair : pairs) values.push_back(pair.now);
  const double usual = computeMedian(values);
  const double by = (hop.scale - 1.0) + hop.shift / usual;
  const bool explains =
      computeMedianError(pairs, 1, hop) < kExplains * computeMedianError(pairs, 1, {});
  const bool hops = explains && std::abs(by) > kHop;
  if (hops && by * last_hop_ <= 0) ++hops_;
  if (hops) last_hop_ = by;
  shown_ = shown_ || hops_ >= kEnoughHops || (hops && std::abs(by) > kLargeHop);
}

// Averages resting samples; restarts changed samples.
void DepthScaleAlignment::remember(const cv::Mat& depth, const cv::Mat& gray,
                                   const ScaleShift& hop) {
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (depth.at<float>(v, u) <= 0) continue;
      float& age = age_.at<float>(v, u);
      age = camera_rests_ ? std::min(age + 1.0F, kLongest) : 1.0F;
      const double value = hop.scale * toAligned(depth.at<float>(v, u)) + hop.shift;
      const double now = inverse_ ? 1e3 / std::max(1e-3, value) : value;
      float& kept = depth_.at<float>(v, u);
      if (kept <= 0) age = 1.0F;
      kept += (static_cast<float>(now) - kept) / age;
      gray_.at<float>(v, u) += (gray.at<float>(v, u) - gray_.at<float>(v, u)) / age;
    }
  }
}

cv::Mat DepthScaleAlignment::steady(const cv::Mat& depth, const cv::Mat& gray,
                                    const cv::Mat& objects) {
  ++frame_;
  if (!shown_ && frame_ > kFirstLook && frame_ % kLookEvery != 0) return depth;
  const int factor = largestReduction(depth.size());
  const cv::Mat small_depth = sparse(depth, factor * kEvery_px);
  const cv::Mat small_gray = sparseGray(gray, factor * kEvery_px);
  if (depth_.empty()) {
    depth_ = small_depth.clone();
    gray_ = small_gray.clone();
    age_ = cv::Mat::ones(depth_.size(), CV_32FC1);
    return depth;
  }
  const cv::Mat around = objects.empty() ? cv::Mat() : cutAroundObjects(objects, factor);
  const std::vector<Pair> pairs = restingPairs(small_depth, small_gray, around);
  ScaleShift hop;
  if (camera_rests_ && pairs.size() >= kFewestPairs) {
    hop = estimateShift(pairs);
    judge(pairs, hop);
    if (!shown_) hop = {};
  }
  remember(small_depth, small_gray, hop);
  if (hop.isNone()) return depth;
  cv::Mat out;
  if (inverse_) {
    // 1 / (scale / z + shift), both in 1/m, is z / (scale + shift z).
    cv::divide(depth, cv::max(depth * (1e-3 * hop.shift) + hop.scale, kNearlyNone), out);
  } else {
    out = depth * hop.scale + hop.shift;
    out.setTo(0, (depth <= 0) | (out < 0));
  }
  return out;
}

}  // namespace hapticast::server
