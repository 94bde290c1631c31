// SPDX-License-Identifier: MIT
#include "client/view/force_plot.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace hapticast::client {

void ForceHistory::add(const TickReport& report) {
  if (ticks_in_last_ == 0) {
    if (points_.size() == kMaxPoints) points_.pop_front();
    points_.push_back({toSeconds(report.time), 0.0, 0.0, 0.0, 0.0, false});
  }
  ForcePoint& point = points_.back();
  point.force_N = std::max(point.force_N, report.force_N.norm());
  point.static_force_N = std::max(point.static_force_N, report.static_force_N.norm());
  point.dynamic_force_N = std::max(point.dynamic_force_N, report.dynamic_force_N.norm());
  point.penetration_mm = std::max(point.penetration_mm, report.penetration_mm);
  point.contact = point.contact || report.contact;
  ticks_in_last_ = (ticks_in_last_ + 1) % kTicksPerPoint;
}

namespace {

const cv::Scalar kGridColor(70, 66, 62);
const cv::Scalar kContactColor(58, 52, 40);

double findPeak(const std::deque<ForcePoint>& points) {
  double top_N = 0.5;
  for (const ForcePoint& point : points) {
    top_N = std::max({top_N, point.force_N, point.static_force_N, point.dynamic_force_N});
  }
  return top_N;
}

/// Position of the axes in the picture.
struct Axes {
  Axes(const std::deque<ForcePoint>& points, cv::Size size)
      : area(56, 30, size.width - 76, size.height - 62) {
    if (!points.empty()) {
      start_s = points.front().time_s;
      span_s = std::max(1.0, points.back().time_s - start_s);
    }
    const double largest_N = findPeak(points);
    step_N = largest_N <= 1.0 ? 0.25 : largest_N <= 2.5 ? 0.5 : 1.0;
    top_N = step_N * std::ceil(largest_N / step_N);
  }
  [[nodiscard]] int column(double time_s) const {
    return area.x + static_cast<int>(std::lround((time_s - start_s) / span_s * area.width));
  }
  [[nodiscard]] int row(double force_N) const {
    return area.y + area.height - static_cast<int>(std::lround(force_N / top_N * area.height));
  }
  void drawUpright(cv::Mat& plot, double time_s, const cv::Scalar& color) const {
    const int at = column(time_s);
    cv::line(plot, {at, area.y}, {at, area.y + area.height}, color);
  }

  cv::Rect area;
  double start_s = 0.0;
  double span_s = 1.0;
  double step_N = 0.25;
  double top_N = 0.5;
};

void drawGrid(cv::Mat& plot, const Axes& axes) {
  const cv::Rect& area = axes.area;
  for (double force_N = 0.0; force_N <= axes.top_N + 1e-9; force_N += axes.step_N) {
    const int row = axes.row(force_N);
    cv::line(plot, {area.x, row}, {area.x + area.width, row}, kGridColor);
    putLabel(plot, cv::format("%.2f N", force_N), {4, row + 4}, kTextColor);
  }
  const double step_s = axes.span_s <= 12.0 ? 1.0 : std::ceil(axes.span_s / 10.0);
  for (double time_s = step_s * std::ceil(axes.start_s / step_s);
       time_s <= axes.start_s + axes.span_s; time_s += step_s) {
    putLabel(plot, cv::format("%.0f s", time_s),
             {axes.column(time_s) - 8, area.y + area.height + 20}, kTextColor);
  }
}

void drawCurve(cv::Mat& plot, const Axes& axes, const std::deque<ForcePoint>& points,
               double ForcePoint::*value, const cv::Scalar& color, int width_px) {
  std::vector<cv::Point> line;
  line.reserve(points.size());
  for (const ForcePoint& point : points) {
    const cv::Point at(axes.column(point.time_s), axes.row(point.*value));
    if (line.empty() || line.back().x != at.x) {
      line.push_back(at);
    } else {
      line.back().y = std::min(line.back().y, at.y);  // peak of the column
    }
  }
  cv::polylines(plot, line, false, color, width_px, cv::LINE_AA);
}

void drawLegend(cv::Mat& plot, int left_px) {
  putLabel(plot, "force at the device", {left_px, 20}, kForceColor);
  putLabel(plot, "static", {left_px + 190, 20}, kStaticForceColor);
  putLabel(plot, "dynamic", {left_px + 270, 20}, kDynamicForceColor);
  putLabel(plot, "shaded: contact   white line: the moment shown above", {left_px + 370, 20},
           kTextColor);
}

}  // namespace

void putLabel(cv::Mat& image, const std::string& text, cv::Point at, const cv::Scalar& color) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
}

cv::Mat drawForcePlot(const ForceHistory& history, double marked_s, cv::Size size) {
  const auto& points = history.points();
  const Axes axes(points, size);
  cv::Mat plot(size, CV_8UC3, kGroundColor);
  for (const ForcePoint& point : points) {
    if (point.contact) axes.drawUpright(plot, point.time_s, kContactColor);
  }
  drawGrid(plot, axes);
  drawCurve(plot, axes, points, &ForcePoint::dynamic_force_N, kDynamicForceColor, 1);
  drawCurve(plot, axes, points, &ForcePoint::static_force_N, kStaticForceColor, 1);
  drawCurve(plot, axes, points, &ForcePoint::force_N, kForceColor, 2);
  // The strongest moment may be older than the plot.
  if (marked_s >= axes.start_s) axes.drawUpright(plot, marked_s, kMomentColor);
  drawLegend(plot, axes.area.x);
  return plot;
}

}  // namespace hapticast::client
