// SPDX-License-Identifier: MIT
// Objectness score of a mask, in the spirit of Alexe, Deselaers and Ferrari 2010; see
// candidates.hpp. Thread: the one that runs Vision.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"
#include "server/vision/segment/initialise/candidates.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"

namespace hapticast::server {

namespace {

// Limits tuned on drawn scenes of objects in hands, and checked on scenes without hands.
constexpr double kObject_px = 2500.0;  // of the view: enough for a contour, few enough for time
constexpr int kRingMargin_px = 16;
constexpr float kIn_px = 2.5F;
constexpr float kOut_px = 3.0F;

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
  double color = 0.0, depth = 0.0, contact = 0.0, border = 0.0, beside_skin = 0.0;
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
  sum.color += color;
  sum.depth += depth;
  const bool skin_outside = m.view.skin.at<unsigned char>(out) != 0;
  if (skin_outside) sum.beside_skin += 1.0;
  const bool leaves_skin = skin_outside && m.view.skin.at<unsigned char>(in) == 0;
  const bool known = m.view.depth.at<float>(out) > 0 && m.view.plane.at<unsigned char>(out) == 0;
  // Things that touch are apart where colour ends.
  if (known && depth < 0.6 && !leaves_skin) sum.contact += 1.0 - color;
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
      if (whole.contains(in) && whole.contains(out)) {
        addPlace(m, in, out, noise, sum);
      } else {
        sum.border += 1.0;
      }
    }
  }
  const double at_border = m.view.shrink * m.at_border_px;
  sum.border += at_border;
  count = std::max(count + at_border, 1.0);
  return {sum.color / count, sum.depth / count, sum.contact / count, sum.border / count,
          sum.beside_skin / count};
}

double diameter_mm(const MaskView& m, const cv::Size& picture) {
  const double middle_mm = std::max(1.0, medianDepth(m.view.depth, m.mask, 1));
  return std::sqrt(4.0 * m.area / CV_PI) / m.view.shrink / pixelsPerMm(middle_mm, picture);
}

}  // namespace

ObjectnessTerms computeObjectnessTerms(const FrameContext& scene, const cv::Mat& mask) {
  if (cv::countNonZero(mask) == 0) return {};
  const MaskView m = makeView(scene, mask);
  if (m.area < 10.0) return {};
  const Contour contour = measureAlongContour(m, scene.noise);
  const double skin = cv::countNonZero(m.mask & m.view.skin) / m.area;
  return {contour.color,
          contour.depth,
          contour.contact,
          contour.border,
          skin,
          contour.beside_skin,
          diameter_mm(m, mask.size())};
}

// The logarithm of the width prefers the whole to its parts, whatever the size. Chosen: a whole
// wider than this is rather a person.
constexpr double kWidest_mm = 200.0;

// Weights fitted to clicks on drawn scenes of objects in hands (five draws, 1,010 clicks): the best
// expected IoU of the choice among the candidates. Only `border` is chosen.
double objectness(const ObjectnessTerms& t) {
  if (t.width_mm <= 0.0) return -10.0;
  return 1.05 * t.color_edge + 0.8 * t.depth_edge - 0.55 * t.contact - 1.1 * t.border -
         1.6 * t.skin + 0.6 * t.beside_skin +
         0.13 * std::log(std::min(t.width_mm, kWidest_mm) / 100.0);
}

std::string toText(const ObjectnessTerms& t) {
  return fmt::format(
      "score {:.2f}: colour edge {:.2f}, depth edge {:.2f}, contact {:.2f}, border {:.2f}, "
      "skin {:.2f}, beside skin {:.2f}, width {:.0f} mm",
      objectness(t), t.color_edge, t.depth_edge, t.contact, t.border, t.skin, t.beside_skin,
      t.width_mm);
}

double objectness(const FrameContext& scene, const cv::Mat& mask) {
  return objectness(computeObjectnessTerms(scene, mask));
}

double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask) {
  if (cv::countNonZero(mask) == 0) return 0.0;
  return diameter_mm(makeView(scene, mask), mask.size());
}

}  // namespace hapticast::server
