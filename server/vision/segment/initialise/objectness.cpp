// SPDX-License-Identifier: MIT
// Objectness score of a mask, in the spirit of Alexe, Deselaers and Ferrari 2010; see
// candidates.hpp. Thread: the one that runs Vision.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"
#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/initialise/candidates.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/rules.hpp"

namespace hapticast::server {

namespace {

// Weights and limits tuned on drawn scenes of objects in hands, and checked on scenes without
// hands.
constexpr double kObject_px = 2500.0;  // of the view: enough for a contour, few enough for time
constexpr int kRingMargin_px = 16;
constexpr float kFirstOfRing_px = 1.5F;
constexpr float kLastOfRing_px = 12.0F;
constexpr float kIn_px = 2.5F;
constexpr float kOut_px = 3.0F;
constexpr double kSmall_mm = 60.0;
constexpr double kSeparates = 0.6;  // colour edge across which a body hardly continues
// Contact across such an edge. With 0 the bear and the bottle of the held scenes lose .5 IoU, and
// with 1 the left hand of a real clip loses .5.
constexpr double kSeparated = 0.5;

struct MaskView {
  GraphRoi view;
  cv::Mat mask;
  cv::Mat distance;  // CV_32FC1, above 0 inside
  double area = 0.0;
  double at_border_px = 0.0;  // pixels at the border of the picture
};

MaskView makeView(const FrameContext& scene, const cv::Mat& mask) {
  MaskView out;
  const double area = cv::countNonZero(mask);
  const double shrink = std::min(1.0, std::sqrt(kObject_px / std::max(area, 1.0)));
  const cv::Rect box = findBoxAround(mask, int(kRingMargin_px / shrink) + 1);
  out.view = GraphRoi::makeWithValleys(scene, box, shrink * shrink * box.area());
  out.mask = out.view.shrinkImage(mask);
  cv::Mat inner;
  cv::Mat outer;
  cv::copyMakeBorder(out.mask, inner, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  cv::distanceTransform(inner, inner, cv::DIST_L2, 5);
  cv::distanceTransform(out.mask == 0, outer, cv::DIST_L2, 5);
  out.distance = inner(cv::Rect({1, 1}, out.mask.size())) - outer;
  out.area = cv::countNonZero(out.mask);
  out.at_border_px = countBorderPixels(mask);
  return out;
}

// Properties of the contour, as means along it.
struct Contour {
  double edge = 0.0, contact = 0.0;
};

// Returns the strength of the depth edge between a place inside and one outside, 0..1; constants
// where depth is missing.
double depthEdge(const MaskView& m, const cv::Point& in, const cv::Point& out,
                 const DepthNoise& noise) {
  const float inside = m.view.depth.at<float>(in);
  const float outside = m.view.depth.at<float>(out);
  if (!(outside > 0)) return 0.4;
  if (m.view.plane.at<unsigned char>(out) != 0) return 0.5;
  if (!(inside > 0)) return 0.3;
  const auto step = double(m.view.step_mm(noise, inside));
  return std::min(1.0, double(std::abs(inside - outside)) / (3.0 * step));
}

// Returns the depth of a valley between a place inside and one outside, 0..1.
double findValley(const MaskView& m, const cv::Point& in, const cv::Point& out) {
  double deepest = 0.0;
  for (const cv::Point& at : {in, (in + out) / 2, out})
    deepest = std::max(deepest, double(m.view.valley.at<float>(at)));
  return deepest;
}

// Adds the properties of one pixel of the contour, with a place inside and one outside.
void addPlace(const MaskView& m, const cv::Point& in, const cv::Point& out, const DepthNoise& noise,
              Contour& sum) {
  const double color =
      std::min(1.0, cv::norm(m.view.lab.at<cv::Vec3f>(in) - m.view.lab.at<cv::Vec3f>(out)) / 25.0);
  const double depth = std::max(depthEdge(m, in, out, noise), findValley(m, in, out));
  const bool hand =
      m.view.skin.at<unsigned char>(out) != 0 && m.view.skin.at<unsigned char>(in) == 0;
  const double edge = hand ? 1.0 : std::max(color, depth);
  sum.edge += edge;
  const bool known = m.view.depth.at<float>(out) > 0 && m.view.plane.at<unsigned char>(out) == 0;
  const bool separate = usesRule(Rule::kColorSeparates) && color > kSeparates;
  if (known && depth < 0.6 && !hand) sum.contact += separate ? kSeparated : 1.0;
}

Contour measureAlongContour(const MaskView& m, const DepthNoise& noise) {
  cv::Mat du;
  cv::Mat dv;
  cv::Mat smooth;
  cv::GaussianBlur(m.distance, smooth, {}, 1.5);
  cv::Sobel(smooth, du, CV_32F, 1, 0);
  cv::Sobel(smooth, dv, CV_32F, 0, 1);
  const cv::Rect whole({0, 0}, m.mask.size());
  Contour sum;
  double count = 0.0;
  for (int v = 0; v < m.mask.rows; ++v) {
    for (int u = 0; u < m.mask.cols; ++u) {
      if (m.mask.at<unsigned char>(v, u) == 0 || m.distance.at<float>(v, u) > 1.2F) continue;
      const cv::Point2f way(du.at<float>(v, u), dv.at<float>(v, u));
      const float length = std::hypot(way.x, way.y);
      if (length < 1e-3F) continue;
      count += 1.0;
      const cv::Point2f at(static_cast<float>(u), static_cast<float>(v));
      const cv::Point in = at + way * (kIn_px / length);
      const cv::Point out = at - way * (kOut_px / length);
      if (whole.contains(in) && whole.contains(out)) addPlace(m, in, out, noise, sum);
    }
  }
  count = std::max(count + m.view.shrink * m.at_border_px, 1.0);
  return {sum.edge / count, sum.contact / count};
}

// Returns the distance of the colours inside from those of the ring, 0..1 (Bhattacharyya).
double computeColorsApart(const MaskView& m) {
  const cv::Mat ring = (m.distance < -kFirstOfRing_px) & (m.distance > -kLastOfRing_px);
  return 1.0 - computeOverlap(ColorHistogram::fromImage(m.view.color, m.mask),
                              ColorHistogram::fromImage(m.view.color, ring));
}

struct Body {
  double stray = 0.0;  // share whose distance from the median depth exceeds the width
  double diameter_mm = 0.0;
  double skin = 0.0;
};

Body fitBody(const MaskView& m, const cv::Size& picture) {
  Body out;
  std::vector<double> depths;
  depths.reserve(static_cast<std::size_t>(m.area));
  for (int v = 0; v < m.mask.rows; ++v) {
    for (int u = 0; u < m.mask.cols; ++u) {
      if (m.mask.at<unsigned char>(v, u) == 0) continue;
      if (m.view.depth.at<float>(v, u) > 0) depths.push_back(double(m.view.depth.at<float>(v, u)));
      if (m.view.skin.at<unsigned char>(v, u) != 0) out.skin += 1.0 / m.area;
    }
  }
  const double middle_mm = depths.empty() ? 1.0 : computeMedian(depths);
  const double across_px = std::sqrt(4.0 * m.area / CV_PI) / m.view.shrink;
  out.diameter_mm = across_px / pixelsPerMm(middle_mm, picture);
  for (const double z : depths) {
    if (std::abs(z - middle_mm) > 0.7 * out.diameter_mm + 40.0) out.stray += 1.0 / m.area;
  }
  return out;
}

}  // namespace

ObjectnessTerms computeObjectnessTerms(const FrameContext& scene, const cv::Mat& mask) {
  if (cv::countNonZero(mask) == 0) return {};
  const MaskView m = makeView(scene, mask);
  if (m.area < 10.0) return {};
  const Contour contour = measureAlongContour(m, scene.noise);
  const Body body = fitBody(m, mask.size());
  return {computeColorsApart(m), contour.edge, contour.contact, body.stray, body.skin,
          body.diameter_mm};
}

double objectness(const ObjectnessTerms& t) {
  if (t.width_mm <= 0.0) return -10.0;
  const double small = std::max(0.0, std::log(kSmall_mm / t.width_mm));
  const std::array<std::pair<Rule, double>, 6> terms{{
      {Rule::kApart, 0.3 * t.apart},
      {Rule::kEdge, 1.6 * t.edge},
      {Rule::kContact, -1.8 * t.contact},
      {Rule::kStray, -2.0 * std::min(0.5, t.stray)},
      {Rule::kSkin, -0.8 * t.skin},
      {Rule::kSmall, -0.8 * small},
  }};
  double sum = 0.0;
  for (const auto& [rule, value] : terms) sum += usesRule(rule) ? value : 0.0;
  return sum;
}

std::string toText(const ObjectnessTerms& t) {
  return fmt::format(
      "score {:.2f}: edge {:.2f}, contact {:.2f}, stray {:.2f}, skin {:.2f}, width {:.0f} mm, "
      "colours apart {:.2f}",
      objectness(t), t.edge, t.contact, t.stray, t.skin, t.width_mm, t.apart);
}

double objectness(const FrameContext& scene, const cv::Mat& mask) {
  return objectness(computeObjectnessTerms(scene, mask));
}

double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask) {
  if (cv::countNonZero(mask) == 0) return 0.0;
  return fitBody(makeView(scene, mask), mask.size()).diameter_mm;
}

}  // namespace hapticast::server
