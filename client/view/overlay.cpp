// SPDX-License-Identifier: MIT
#include "client/view/overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

namespace hapticast::client {

namespace {

constexpr int kPictureWidth_px = 960;
constexpr int kPlotHeight_px = 260;
// Above the video: the text, and room for a cone that touches near the upper edge.
constexpr int kHeadHeight_px = 90;
constexpr double kArrow_px_per_N = 90.0;
constexpr double kCone_mm = 26.0;
// Height towards the viewer is drawn obliquely, up and a little to the right.
const Vec2 kObliqueZ(0.35, -0.75);

const cv::Scalar kGround(28, 26, 24);
const cv::Scalar kGrid(70, 66, 62);
const cv::Scalar kText(215, 212, 208);
const cv::Scalar kTotal(250, 250, 250);
const cv::Scalar kStatic(235, 170, 70);
const cv::Scalar kDynamic(80, 130, 250);
const cv::Scalar kContactBand(58, 52, 40);
const cv::Scalar kArrow(60, 60, 240);

void putLabel(cv::Mat& image, const std::string& text, cv::Point at, const cv::Scalar& color) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
}

/// Rounded, and kept where drawing arithmetic cannot overflow.
cv::Point toPoint(const Vec2& position) {
  const auto coordinate = [](double value) {
    return static_cast<int>(std::lround(std::clamp(value, -1e4, 1e4)));
  };
  return {coordinate(position.x()), coordinate(position.y())};
}

/// The stylus: a cone whose tip is the HIP, opening towards the viewer.
void drawCone(cv::Mat& image, const Vec2& tip_px, double px_per_mm) {
  const Vec2 top = tip_px + kObliqueZ * kCone_mm * px_per_mm;
  const int radius = static_cast<int>(std::lround(0.22 * kCone_mm * px_per_mm));
  const Vec2 side = Vec2(-kObliqueZ.y(), kObliqueZ.x()).normalized() * radius;
  const std::array<cv::Point, 3> body{toPoint(tip_px), toPoint(top - side), toPoint(top + side)};
  cv::Mat solid = image.clone();
  cv::fillConvexPoly(solid, body, cv::Scalar(200, 205, 60), cv::LINE_AA);
  cv::ellipse(solid, toPoint(top), {radius, radius * 2 / 5}, 25.0, 0.0, 360.0,
              cv::Scalar(225, 230, 110), cv::FILLED, cv::LINE_AA);
  cv::addWeighted(solid, 0.75, image, 0.25, 0.0, image);
  cv::circle(image, toPoint(tip_px), 3, cv::Scalar(255, 255, 255), cv::FILLED, cv::LINE_AA);
}

void drawForce(cv::Mat& image, const Vec2& tip_px, const Vec3& force_N) {
  const Vec2 oblique = kObliqueZ * force_N.z();
  const Vec2 end = tip_px + kArrow_px_per_N * (Vec2(force_N.x(), -force_N.y()) + oblique);
  if ((end - tip_px).norm() < 2.0) return;
  cv::arrowedLine(image, toPoint(tip_px), toPoint(end), cv::Scalar(0, 0, 0), 7, cv::LINE_AA, 0,
                  0.22);
  cv::arrowedLine(image, toPoint(tip_px), toPoint(end), kArrow, 4, cv::LINE_AA, 0, 0.22);
}

std::string describe(const TickReport& report) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "t %.2f s   |F| %.2f N (%.2f, %.2f, %.2f)   penetration %.2f mm   %s",
                toSeconds(report.play_time), report.force_N.norm(), report.force_N.x(),
                report.force_N.y(), report.force_N.z(), report.penetration_mm,
                report.contact ? "in contact" : "no contact");
  return text.data();
}

}  // namespace

void Overlay::add(const TickReport& report) {
  if (ticks_in_point_ == 0) points_.push_back({toSeconds(report.time), 0.0, 0.0, 0.0, false});
  PlotPoint& point = points_.back();
  point.force_N = std::max(point.force_N, report.force_N.norm());
  point.static_force_N = std::max(point.static_force_N, report.static_force_N.norm());
  point.dynamic_force_N = std::max(point.dynamic_force_N, report.dynamic_force_N.norm());
  point.contact = point.contact || report.contact;
  ticks_in_point_ = (ticks_in_point_ + 1) % kPlotStep;
}

cv::Mat Overlay::draw(const cv::Mat& picture, const TickReport& report,
                      const Workspace& workspace) const {
  const double scale = static_cast<double>(kPictureWidth_px) / workspace.width_px;
  const cv::Size size(kPictureWidth_px, static_cast<int>(std::lround(scale * workspace.height_px)));
  cv::Mat canvas(kHeadHeight_px + size.height + kPlotHeight_px, size.width, CV_8UC3, kGround);
  if (!picture.empty()) {
    cv::resize(picture, canvas(cv::Rect({0, kHeadHeight_px}, size)), size, 0.0, 0.0,
               cv::INTER_AREA);
  }

  cv::Mat scene = canvas(cv::Rect(0, 0, size.width, kHeadHeight_px + size.height));
  const Vec2 hip_px = scale * workspace.toImage(report.hip_mm.head<2>());
  // A HIP beside the picture is shown at its edge.
  const Vec2 tip_px = hip_px.cwiseMax(Vec2::Zero()).cwiseMin(Vec2(size.width, size.height)) +
                      Vec2(0.0, kHeadHeight_px);
  drawCone(scene, tip_px, scale / workspace.mmPerPixel().x());
  drawForce(scene, tip_px, report.force_N);
  putLabel(canvas, describe(report), {10, 18}, kText);
  const cv::Rect plot(0, scene.rows, size.width, kPlotHeight_px);
  drawPlot(canvas(plot), toSeconds(report.time));
  return canvas;
}

void Overlay::drawPlot(cv::Mat canvas, double marked_s) const {
  const cv::Rect area(56, 30, canvas.cols - 76, canvas.rows - 62);
  const double start_s = points_.empty() ? 0.0 : points_.front().time_s;
  const double span_s = points_.empty() ? 1.0 : std::max(1.0, points_.back().time_s - start_s);
  double top_N = 0.5;
  for (const PlotPoint& point : points_) {
    top_N = std::max({top_N, point.force_N, point.static_force_N, point.dynamic_force_N});
  }
  const double step_N = top_N <= 1.0 ? 0.25 : top_N <= 2.5 ? 0.5 : 1.0;
  top_N = step_N * std::ceil(top_N / step_N);
  const auto column = [&](double time_s) {
    return area.x + static_cast<int>(std::lround((time_s - start_s) / span_s * area.width));
  };
  const auto row = [&](double force_N) {
    return area.y + area.height - static_cast<int>(std::lround(force_N / top_N * area.height));
  };

  for (const PlotPoint& point : points_) {
    if (!point.contact) continue;
    cv::line(canvas, {column(point.time_s), area.y}, {column(point.time_s), area.y + area.height},
             kContactBand);
  }
  for (double force_N = 0.0; force_N <= top_N + 1e-9; force_N += step_N) {
    cv::line(canvas, {area.x, row(force_N)}, {area.x + area.width, row(force_N)}, kGrid);
    putLabel(canvas, cv::format("%.2f N", force_N), {4, row(force_N) + 4}, kText);
  }
  const double step_s = span_s <= 12.0 ? 1.0 : std::ceil(span_s / 10.0);
  for (double time_s = 0.0; time_s <= span_s; time_s += step_s) {
    putLabel(canvas, cv::format("%.0f s", time_s),
             {column(start_s + time_s) - 8, area.y + area.height + 20}, kText);
  }

  const auto curve = [&](double PlotPoint::*value, const cv::Scalar& color, int width) {
    std::vector<cv::Point> line;
    line.reserve(points_.size());
    for (const PlotPoint& point : points_)
      line.emplace_back(column(point.time_s), row(point.*value));
    cv::polylines(canvas, line, false, color, width, cv::LINE_AA);
  };
  curve(&PlotPoint::dynamic_force_N, kDynamic, 1);
  curve(&PlotPoint::static_force_N, kStatic, 1);
  curve(&PlotPoint::force_N, kTotal, 2);
  cv::line(canvas, {column(marked_s), area.y}, {column(marked_s), area.y + area.height}, kArrow);

  putLabel(canvas, "force at the device", {area.x, 20}, kTotal);
  putLabel(canvas, "static", {area.x + 190, 20}, kStatic);
  putLabel(canvas, "dynamic", {area.x + 270, 20}, kDynamic);
  putLabel(canvas, "shaded: contact   red line: the moment shown above", {area.x + 370, 20}, kText);
}

}  // namespace hapticast::client
