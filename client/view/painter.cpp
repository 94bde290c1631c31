// SPDX-License-Identifier: MIT
#include "client/view/painter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "client/view/status.hpp"

namespace hapticast::client {

namespace {

constexpr double kArrowShare = 0.09;  // share of the picture's width per N; 3.3 N are a third of it
constexpr double kCone_mm = 18.0;
// Distance of the eye for the perspective. Chosen: 120 nominal mm, so that a nearer cone is visibly
// larger.
constexpr double kEye_mm = 120.0;
const Vec2 kTowardsViewer(0.35, -0.75);  // up and a little to the right, px per px
// Forces with a shorter projection have the direction of kTowardsViewer; per magnitude. Chosen.
constexpr double kLeastProjection = 0.05;
constexpr double kInvisible_N = 5e-3;  // a shorter arrow is not visible
constexpr double kMost_px = 1e4;       // OpenCV's drawing functions can represent it
// Points in 1/16 px, so that slow motions look smooth.
constexpr int kShift = 4;
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kRimColor(20, 20, 20);

/// Clamps the coordinates; NaN counts as 0.
Vec2 clampPoint(const Vec2& point) {
  const auto clamp = [](double value) {
    return std::isfinite(value) ? std::clamp(value, -kMost_px, kMost_px) : 0.0;
  };
  return {clamp(point.x()), clamp(point.y())};
}

/// Converts a point for OpenCV, whose whole numbers are the centres of pixels.
cv::Point toFixed(const Vec2& point) {
  const Vec2 fixed = (clampPoint(point) - Vec2(0.5, 0.5)) * (1 << kShift);
  return {static_cast<int>(std::lround(fixed.x())), static_cast<int>(std::lround(fixed.y()))};
}

void drawLine(cv::Mat& image, const Vec2& from, const Vec2& to, const cv::Scalar& color,
              double width_px) {
  const int width = std::max(1, static_cast<int>(std::lround(width_px)));
  cv::line(image, toFixed(from), toFixed(to), color, width, cv::LINE_AA, kShift);
}

void drawRing(cv::Mat& image, const Vec2& centre, double radius_px, const cv::Scalar& color,
              int width_px) {
  cv::circle(image, toFixed(centre), static_cast<int>(radius_px * (1 << kShift)), color, width_px,
             cv::LINE_AA, kShift);
}

template <std::size_t N>
void fill(cv::Mat& image, const std::array<Vec2, N>& corners, const cv::Scalar& color) {
  std::array<cv::Point, N> fixed;
  std::transform(corners.begin(), corners.end(), fixed.begin(), toFixed);
  cv::fillConvexPoly(image, fixed.data(), static_cast<int>(N), color, cv::LINE_AA, kShift);
}

/// Draws an arrow with a rim, which keeps it visible on a picture of its colour.
void drawArrow(cv::Mat& image, const Vec2& from, const Vec2& way, double width_px,
               const cv::Scalar& color) {
  const double length = way.norm();
  if (length < 2.0) return;
  const Vec2 along = way / length;
  const Vec2 across(-along.y(), along.x());
  const double head = std::min(length, 4.0 * width_px);
  const Vec2 end = from + way;
  const Vec2 neck = end - head * along;
  const auto paint = [&](double rim_px, const cv::Scalar& paint_color) {
    drawLine(image, from, neck, paint_color, width_px + 2.0 * rim_px);
    const Vec2 side = (0.5 * head + 1.5 * rim_px) * across;
    fill<3>(
        image,
        {end + 2.0 * rim_px * along, neck - rim_px * along + side, neck - rim_px * along - side},
        paint_color);
  };
  paint(1.0, kRimColor);
  paint(0.0, color);
}

/// Draws a thin, dashed arrow: a part of a force.
void drawDashedArrow(cv::Mat& image, const Vec2& from, const Vec2& way, double width_px,
                     const cv::Scalar& color) {
  const double length = way.norm();
  if (length < 2.0) return;
  const Vec2 along = way / length;
  const double head = std::min(length, 4.0 * width_px);
  const double dash = 3.5 * width_px;
  for (double at = 0.0; at < length - head; at += 1.7 * dash) {
    const Vec2 begin = from + at * along;
    const Vec2 end = from + std::min(at + dash, length - head) * along;
    drawLine(image, begin, end, kRimColor, width_px + 2.0);
    drawLine(image, begin, end, color, width_px);
  }
  const Vec2 end = from + way;
  const Vec2 side = 0.5 * head * Vec2(-along.y(), along.x());
  fill<3>(image, {end, end - head * along + side, end - head * along - side}, color);
}

/// Returns how far the HIP is drawn above the spot that it would touch, nominal mm: less than its
/// height above the object, so that it stays near the pointer. 0 beside objects and in contact.
double computeDrawnHeight_mm(const TickReport& report) {
  constexpr double kMost_mm = 12.0;  // chosen
  const double gap_mm = report.contact ? 0.0 : surfaceGap_mm(report).value_or(0.0);
  return gap_mm > 0.0 ? gap_mm / (1.0 + gap_mm / kMost_mm) : 0.0;
}

/// Draws the distance to the surface: a line from the HIP down to its shadow at `foot`, the spot
/// that the HIP would touch.
void drawGap(cv::Mat& image, const TickReport& report, const Vec2& foot, const Vec2& tip,
             double unit) {
  if (!(computeDrawnHeight_mm(report) > 0.0)) return;
  drawLine(image, tip, foot, kRimColor, 3.0 * unit);
  drawLine(image, tip, foot, kGapColor, unit);
  const cv::Size shadow(static_cast<int>(8.0 * unit), static_cast<int>(4.0 * unit));
  const cv::Point at(static_cast<int>(clampPoint(foot).x()),
                     static_cast<int>(clampPoint(foot).y()));
  cv::ellipse(image, at, shadow, 0.0, 0.0, 360.0, kRimColor, cv::FILLED, cv::LINE_AA);
  cv::ellipse(image, at, shadow, 0.0, 0.0, 360.0, kGapColor, 1, cv::LINE_AA);
}

/// Draws the stylus: a translucent cone with its apex at `tip`, opening towards the viewer.
void drawCone(cv::Mat& image, const Vec2& tip, double size_px) {
  constexpr int kSides = 28;
  const Vec2 top = tip + size_px * kTowardsViewer;
  const double radius = 0.24 * size_px;
  const Vec2 along = kTowardsViewer.normalized();
  const Vec2 across(-along.y(), along.x());
  const auto rim = [&](double angle) -> Vec2 {
    return top + radius * (std::cos(angle) * across + 0.4 * std::sin(angle) * along);
  };
  std::array<Vec2, kSides> opening;
  for (int i = 0; i < kSides; ++i)
    opening[static_cast<std::size_t>(i)] = rim(2.0 * CV_PI * i / kSides);
  const Vec2 low = tip.cwiseMin(top - Vec2(radius, radius));
  const Vec2 size = tip.cwiseMax(top + Vec2(radius, radius)) - low;
  const cv::Rect around = cv::Rect2d(low.x() - 2, low.y() - 2, size.x() + 4, size.y() + 4) &
                          cv::Rect2d({0, 0}, cv::Size2d(image.size()));
  if (around.empty()) return;
  cv::Mat below = image(around);
  const cv::Mat seen_through = below.clone();
  fill<3>(image, {tip, rim(0.0), top}, kConeColor);
  fill<3>(image, {tip, top, rim(CV_PI)}, cv::Scalar(140, 150, 40));
  fill(image, opening, cv::Scalar(220, 235, 120));
  cv::addWeighted(below, 0.78, seen_through, 0.22, 0.0, below);
}

}  // namespace

ScenePlace::ScenePlace(const Workspace& workspace, const Vec2& corner, const Vec2& room)
    : workspace_(workspace) {
  const Vec2 picture(workspace.width_px, workspace.height_px);
  scale_ = std::max(room.cwiseQuotient(picture).minCoeff(), 1e-3);
  corner_ = corner + 0.5 * (room - scale_ * picture);
}

Vec2 ScenePlace::end() const {
  return corner_ + scale_ * Vec2(workspace_.width_px, workspace_.height_px);
}

bool ScenePlace::contains(const Vec2& point) const {
  return (point.array() >= corner_.array()).all() && (point.array() < end().array()).all();
}

Vec2 ScenePlace::fromNominal(const Vec2& nominal_mm) const {
  return fromImage(workspace_.toImage(nominal_mm));
}

Vec2 ScenePlace::fromImage(const Vec2& image_px) const {
  return corner_ + clampPoint(scale_ * image_px);
}

Vec2 ScenePlace::toNominal(const Vec2& point) const {
  return workspace_.toNominal((point - corner_) / scale_);
}

Vec2 ScenePlace::arrow(const Vec3& force_N) const {
  const double magnitude_N = force_N.norm();
  const Vec2 projected = Vec2(force_N.x(), -force_N.y()) + kTowardsViewer * force_N.z();
  const bool visible = projected.norm() > kLeastProjection * magnitude_N;
  const Vec2 direction = (visible ? projected : kTowardsViewer).normalized();
  return clampPoint(kArrowShare * size().x() * magnitude_N * direction);
}

double renderedShare(const TickReport& report) {
  const double before_N = (report.static_force_N + report.dynamic_force_N).norm();
  const double force_N = report.force_N.norm();
  if (!(before_N > kInvisible_N) || !(force_N > kInvisible_N)) return 0.0;
  return std::min(force_N / before_N, 1.0);
}

cv::Mat fitPicture(const cv::Mat& picture, cv::Size size) {
  if (picture.empty()) return {size, CV_8UC3, kGroundColor};
  cv::Mat fitted;
  cv::resize(picture, fitted, size, 0.0, 0.0,
             size.width < picture.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  return fitted;
}

void drawTouch(cv::Mat& image, const ScenePlace& place, const TickReport& report,
               const PointerTarget& pointer) {
  const auto clampToPicture = [&place](const Vec2& at) -> Vec2 {
    return at.cwiseMax(place.corner()).cwiseMin(place.end());
  };
  const Vec2 foot = clampToPicture(place.fromNominal(report.hip_mm.head<2>()));
  const Vec2 tip = clampToPicture(
      foot + clampPoint(computeDrawnHeight_mm(report) * place.pixelsPerMm() * kTowardsViewer));
  const double unit = std::max(1.0, place.size().x() / 960.0);  // of lines, for large images
  if (pointer.known) {
    const Vec2 goal = place.fromNominal(pointer.position_mm.head<2>());
    drawLine(image, goal, foot, cv::Scalar::all(190), 1.0);
    drawRing(image, goal, 6.0 * unit, kWhite, 2);
  }
  const double nearness = kEye_mm / std::max(kEye_mm - report.hip_mm.z(), 0.3 * kEye_mm);
  drawGap(image, report, foot, tip, unit);
  drawCone(image, tip, kCone_mm * place.pixelsPerMm() * nearness);
  if (report.contact)
    drawRing(image, place.fromNominal(report.contact_mm.head<2>()), 7.0 * unit, kContactColor, 2);
  drawArrow(image, tip, place.arrow(report.force_N), 7.0 * unit, kForceColor);
  const double share = renderedShare(report);
  const double thin = 2.0 * unit;
  drawDashedArrow(image, tip, place.arrow(share * report.static_force_N), thin, kStaticForceColor);
  drawDashedArrow(image, tip, place.arrow(share * report.dynamic_force_N), thin,
                  kDynamicForceColor);
  drawRing(image, tip, 3.5 * unit, kWhite, cv::FILLED);
}

void drawShade(cv::Mat& image, const ScenePlace& place, const ReliefMesh& mesh) {
  const cv::Mat seen_through = image.clone();
  for (const auto& cell : mesh.cells) {
    std::array<Vec2, 4> corners;
    float light = 0.0F;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const ReliefMesh::Corner& corner = mesh.corners[static_cast<std::size_t>(cell[i])];
      corners[i] = place.fromNominal(corner.position_mm.head<2>());
      light += 0.25F * corner.light;
    }
    std::array<cv::Point, 4> fixed;
    std::transform(corners.begin(), corners.end(), fixed.begin(), toFixed);
    cv::fillConvexPoly(image, fixed.data(), 4, std::min(light, 1.0F) * cv::Scalar(185, 225, 255),
                       cv::LINE_8, kShift);
  }
  cv::addWeighted(image, 0.84, seen_through, 0.16, 0.0, image);
}

void drawOutlines(cv::Mat& image, const ScenePlace& place,
                  const std::vector<std::vector<cv::Point2f>>& lines) {
  std::vector<cv::Point> fixed;
  for (const auto& line : lines) {
    fixed.clear();
    for (const cv::Point2f& point : line)
      fixed.push_back(toFixed(place.fromImage(Vec2(double{point.x}, double{point.y}))));
    cv::polylines(image, fixed, true, cv::Scalar::all(235), 2, cv::LINE_AA, kShift);
  }
}

int labelWidth_px(const std::string& text) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, kLabelSize, 1, nullptr).width;
}

void drawLabel(cv::Mat& image, const std::string& text, cv::Point at, const cv::Scalar& color,
               double size) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, size, color, 1, cv::LINE_AA);
}

}  // namespace hapticast::client
