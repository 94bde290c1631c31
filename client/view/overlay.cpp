// SPDX-License-Identifier: MIT
#include "client/view/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "client/view/force_plot.hpp"

namespace hapticast::client {

namespace {

constexpr int kPictureWidth_px = 960;
constexpr int kPlotHeight_px = 260;
// Area above the video: text, and a cone at the upper edge.
constexpr int kHeadHeight_px = 90;
constexpr double kArrow_px_per_N = 90.0;
constexpr double kCone_mm = 26.0;
// Oblique projection of the height: up and a little to the right.
const Vec2 kObliqueZ(0.35, -0.75);

/// Rounds, and clamps to the safe range of the drawing functions.
cv::Point toPoint(const Vec2& position) {
  const auto coordinate = [](double value) {
    return static_cast<int>(std::lround(std::clamp(value, -1e4, 1e4)));
  };
  return {coordinate(position.x()), coordinate(position.y())};
}

/// Draws the stylus: a cone with its apex at the HIP, opening towards the viewer.
void drawCone(cv::Mat& image, const Vec2& tip_px, double px_per_mm) {
  const Vec2 top = tip_px + kObliqueZ * kCone_mm * px_per_mm;
  const int radius = static_cast<int>(std::lround(0.22 * kCone_mm * px_per_mm));
  const Vec2 side = Vec2(-kObliqueZ.y(), kObliqueZ.x()).normalized() * radius;
  const std::array<cv::Point, 3> body{toPoint(tip_px), toPoint(top - side), toPoint(top + side)};
  // The covered area and its rim.
  const cv::Rect covered =
      cv::boundingRect(body) + cv::Size(2 * radius, 2 * radius) - cv::Point(radius, radius);
  const cv::Rect around = covered & cv::Rect({0, 0}, image.size());
  cv::Mat below = image(around);
  const cv::Mat seen_through = below.clone();
  cv::fillConvexPoly(image, body, cv::Scalar(200, 205, 60), cv::LINE_AA);
  cv::ellipse(image, toPoint(top), {radius, radius * 2 / 5}, 25.0, 0.0, 360.0,
              cv::Scalar(225, 230, 110), cv::FILLED, cv::LINE_AA);
  cv::addWeighted(below, 0.75, seen_through, 0.25, 0.0, below);
  cv::circle(image, toPoint(tip_px), 3, cv::Scalar(255, 255, 255), cv::FILLED, cv::LINE_AA);
}

void drawForce(cv::Mat& image, const Vec2& tip_px, const Vec3& force_N, const cv::Scalar& color,
               int width_px) {
  const Vec2 oblique = kObliqueZ * force_N.z();
  const Vec2 end = tip_px + kArrow_px_per_N * (Vec2(force_N.x(), -force_N.y()) + oblique);
  if ((end - tip_px).norm() < 2.0) return;
  cv::arrowedLine(image, toPoint(tip_px), toPoint(end), cv::Scalar(0, 0, 0), width_px + 3,
                  cv::LINE_AA, 0, 0.22);
  cv::arrowedLine(image, toPoint(tip_px), toPoint(end), color, width_px, cv::LINE_AA, 0, 0.22);
}

std::string caption(const TickReport& report) {
  return cv::format("t %.2f s   |F| %.2f N (%.2f, %.2f, %.2f)   penetration %.2f mm   %s",
                    toSeconds(report.time), report.force_N.norm(), report.force_N.x(),
                    report.force_N.y(), report.force_N.z(), report.penetration_mm,
                    report.contact ? "in contact" : "no contact");
}

}  // namespace

cv::Mat drawOverlay(const cv::Mat& picture, const TickReport& report, const Workspace& workspace,
                    const ForceHistory& history) {
  const double scale = static_cast<double>(kPictureWidth_px) / workspace.width_px;
  const cv::Size size(kPictureWidth_px, static_cast<int>(std::lround(scale * workspace.height_px)));
  cv::Mat scene(kHeadHeight_px + size.height, size.width, CV_8UC3, kGroundColor);
  if (!picture.empty()) {
    cv::Mat below_head = scene(cv::Rect({0, kHeadHeight_px}, size));
    cv::resize(picture, below_head, size, 0.0, 0.0, cv::INTER_AREA);
  }
  const Vec2 hip_px = scale * workspace.toImage(report.hip_mm.head<2>());
  // A HIP outside the picture is shown at its edge.
  const Vec2 tip_px = hip_px.cwiseMax(Vec2::Zero()).cwiseMin(Vec2(size.width, size.height)) +
                      Vec2(0.0, kHeadHeight_px);
  drawCone(scene, tip_px, scale / workspace.mmPerPixel().x());
  drawForce(scene, tip_px, report.force_N, kForceColor, 7);
  drawForce(scene, tip_px, report.static_force_N, kStaticForceColor, 3);
  drawForce(scene, tip_px, report.dynamic_force_N, kDynamicForceColor, 3);
  putLabel(scene, caption(report), {10, 18}, kTextColor);

  cv::Mat overlay;
  cv::vconcat(scene, drawForcePlot(history, toSeconds(report.time), {size.width, kPlotHeight_px}),
              overlay);
  return overlay;
}

}  // namespace hapticast::client
