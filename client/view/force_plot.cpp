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
const cv::Scalar kZeroColor(150, 146, 142);
const cv::Scalar kContactShade(58, 52, 40);
const cv::Scalar kMomentColor(250, 250, 250);
constexpr double kRecent_s = 8.0;  // chosen: a press and its release
// Room for labels in the plot of the last seconds: beside it, and a line above and below it.
constexpr int kLabel_px = 58;
constexpr int kLine_px = 19;
constexpr int kNameGap_px = 10;
constexpr int kHead_px = 30;  // room for the names above the plot of the whole run

double findPeak(const std::deque<ForcePoint>& points) {
  double top_N = 0.5;
  for (const ForcePoint& point : points) {
    top_N = std::max({top_N, point.force_N, point.static_force_N, point.dynamic_force_N});
  }
  return top_N;
}

/// Position of the axes in the picture.
struct Axes {
  [[nodiscard]] int column(double time_s) const {
    return area.x + static_cast<int>(std::lround((time_s - start_s) / span_s * area.width));
  }
  [[nodiscard]] int row(double value) const {
    return area.y + area.height -
           static_cast<int>(std::lround(std::min(value / top, 1.0) * area.height));
  }
  void drawUpright(cv::Mat& plot, double time_s, const cv::Scalar& color) const {
    const int at = column(time_s);
    cv::line(plot, {at, area.y}, {at, area.y + area.height}, color);
  }

  cv::Rect area;
  double start_s = 0.0;
  double span_s = 1.0;
  double top = 1.0;
};

/// Returns the distance of the grid's lines for forces up to `largest_N`.
double gridStep_N(double largest_N) {
  return largest_N <= 1.0 ? 0.25 : largest_N <= 2.5 ? 0.5 : 1.0;
}

/// Returns axes for all points.
Axes enclose(const std::deque<ForcePoint>& points, cv::Size size) {
  Axes axes{{kLabel_px, kHead_px, size.width - kLabel_px - 20, size.height - kHead_px - 32}};
  if (!points.empty()) {
    axes.start_s = points.front().time_s;
    axes.span_s = std::max(1.0, points.back().time_s - axes.start_s);
  }
  const double largest_N = findPeak(points);
  const double step_N = gridStep_N(largest_N);
  axes.top = step_N * std::ceil(largest_N / step_N);
  return axes;
}

void drawGrid(cv::Mat& plot, const Axes& axes) {
  const cv::Rect& area = axes.area;
  for (double force_N = 0.0; force_N <= axes.top + 1e-9; force_N += gridStep_N(axes.top)) {
    const int row = axes.row(force_N);
    cv::line(plot, {area.x, row}, {area.x + area.width, row},
             force_N == 0.0 ? kZeroColor : kGridColor);
    drawLabel(plot, cv::format("%.2f N", force_N), {4, row + 4}, kTextColor);
  }
  const double step_s = axes.span_s <= 12.0 ? 1.0 : std::ceil(axes.span_s / 10.0);
  for (double time_s = step_s * std::ceil(axes.start_s / step_s);
       time_s <= axes.start_s + axes.span_s; time_s += step_s) {
    drawLabel(plot, cv::format("%.0f s", time_s),
              {axes.column(time_s) - 8, area.y + area.height + 20}, kTextColor);
  }
}

void drawCurve(cv::Mat& plot, const Axes& axes, const std::deque<ForcePoint>& points,
               const Curve& curve) {
  std::vector<cv::Point> line;
  line.reserve(points.size());
  for (const ForcePoint& point : points) {
    if (point.time_s < axes.start_s) continue;
    const cv::Point at(axes.column(point.time_s), axes.row(point.*curve.value));
    if (line.empty() || line.back().x != at.x) {
      line.push_back(at);
    } else {
      line.back().y = std::min(line.back().y, at.y);  // peak of the column
    }
  }
  cv::polylines(plot, line, false, curve.color, 1, cv::LINE_AA);
}

/// Writes the names of the curves side by side, from `at` to the right. Returns the end of the
/// text.
int nameCurves(cv::Mat& plot, std::span<const Curve> curves, cv::Point at) {
  for (const Curve& curve : curves) {
    drawLabel(plot, curve.name, at, curve.color);
    at.x += labelWidth_px(curve.name) + kNameGap_px;
  }
  return at.x;
}

/// Returns axes for the last seconds, with room for the labels.
Axes encloseRecent(const std::deque<ForcePoint>& points, double least,
                   std::span<const Curve> curves, cv::Size size) {
  const cv::Rect area(kLabel_px, kLine_px, std::max(1, size.width - kLabel_px - 4),
                      std::max(1, size.height - 2 * kLine_px));
  Axes axes{area, -kRecent_s, kRecent_s, least};
  if (!points.empty()) axes.start_s = points.back().time_s - kRecent_s;
  for (const ForcePoint& point : points) {
    if (point.time_s < axes.start_s) continue;
    for (const Curve& curve : curves) {
      while (point.*curve.value > axes.top && axes.top < 1e6) axes.top *= 2.0;
    }
  }
  return axes;
}

void drawRecentAxes(cv::Mat& plot, const Axes& axes, const std::string& unit) {
  const cv::Rect& area = axes.area;
  for (const double value : {axes.top, 0.5 * axes.top, 0.0}) {
    const int row = axes.row(value);
    cv::line(plot, {area.x, row}, {area.x + area.width, row},
             value == 0.0 ? kZeroColor : kGridColor);
  }
  drawLabel(plot, cv::format("%g ", axes.top) + unit, {2, axes.row(axes.top) + 5}, kTextColor);
  drawLabel(plot, "0", {2, axes.row(0.0) + 5}, kTextColor);
  const int below = area.y + area.height + kLine_px - 3;
  drawLabel(plot, "-8 s", {area.x, below}, kTextColor);
  drawLabel(plot, "-4 s", {axes.column(axes.start_s + 4.0) - 14, below}, kTextColor);
  drawLabel(plot, "now", {area.x + area.width - labelWidth_px("now"), below}, kTextColor);
}

}  // namespace

cv::Mat drawForcePlot(const ForceHistory& history, double marked_s, cv::Size size) {
  const auto& points = history.points();
  const Axes axes = enclose(points, size);
  cv::Mat plot(size, CV_8UC3, kGroundColor);
  for (const ForcePoint& point : points) {
    if (point.contact) axes.drawUpright(plot, point.time_s, kContactShade);
  }
  drawGrid(plot, axes);
  for (const Curve& curve : kForceCurves) drawCurve(plot, axes, points, curve);
  // The strongest moment may be older than the plot.
  if (marked_s >= axes.start_s) axes.drawUpright(plot, marked_s, kMomentColor);
  const int end_px = nameCurves(plot, kForceCurves, {axes.area.x, kHead_px - 10});
  drawLabel(plot, "shaded: contact   white line: the moment shown above", {end_px, kHead_px - 10},
            kTextColor);
  return plot;
}

cv::Mat drawRecentPlot(const ForceHistory& history, double least, const std::string& unit,
                       std::span<const Curve> curves, cv::Size size) {
  const auto& points = history.points();
  const Axes axes = encloseRecent(points, least, curves, size);
  cv::Mat plot(size, CV_8UC3, kGroundColor);
  drawRecentAxes(plot, axes, unit);
  int names_px = 0;
  for (const Curve& curve : curves) names_px += labelWidth_px(curve.name) + kNameGap_px;
  for (const Curve& curve : curves) drawCurve(plot, axes, points, curve);
  (void)nameCurves(plot, curves, {std::clamp(size.width - names_px, 2, axes.area.x), kLine_px - 8});
  return plot;
}

}  // namespace hapticast::client
