// SPDX-License-Identifier: MIT
// Plots of the force over time, for window, film and screenshot.
// Thread: any (pure functions).
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "client/haptics/tick_report.hpp"
#include "client/view/painter.hpp"

namespace hapticast::client {

/// One point of a plot: the largest magnitudes in several successive ticks. Thread: one.
struct ForcePoint {
  double time_s = 0.0;  ///< begin of the ticks, since the first tick of the run
  double force_N = 0.0;
  double static_force_N = 0.0;
  double dynamic_force_N = 0.0;
  double penetration_mm = 0.0;
  bool contact = false;  ///< true if any tick was in contact
};

/// The points of the last minute.
class ForceHistory {
 public:
  /// The values are a choice: 5 ms per point, for one minute. A plot of 900 px cannot show more
  /// points. A full history occupies 576 kB.
  static constexpr std::size_t kTicksPerPoint = 5;
  static constexpr std::size_t kSeconds = 60;
  static constexpr std::size_t kMaxPoints = kSeconds * 1000 / kTicksPerPoint;

  /// Adds the report of one tick, and removes points that are older than a minute.
  void add(const TickReport& report);
  /// Returns the points, the oldest first. There are at most kMaxPoints.
  [[nodiscard]] const std::deque<ForcePoint>& points() const { return points_; }

 private:
  std::deque<ForcePoint> points_;
  std::size_t ticks_in_last_ = 0;
};

/// One line of a plot.
struct Curve {
  double ForcePoint::*value;
  cv::Scalar color;       ///< BGR
  const char* name = "";  ///< written above the plot, in the colour of the curve
};
/// The curves of the forces. The last one is drawn on top.
inline const std::array<Curve, 3> kForceCurves{
    {{&ForcePoint::dynamic_force_N, kDynamicForceColor, "dynamic"},
     {&ForcePoint::static_force_N, kStaticForceColor, "static"},
     {&ForcePoint::force_N, kForceColor, "device"}}};

/// Returns a plot of kForceCurves at all points of `history`: a CV_8UC3 picture of `size` px (at
/// least 100 x 100), with a shaded background during contact, and a mark at the time `marked_s`.
/// All times count from the first tick of the run.
[[nodiscard]] cv::Mat drawForcePlot(const ForceHistory& history, double marked_s, cv::Size size);

/// Returns a plot of `curves` in the last eight seconds: a CV_8UC3 picture of `size` px. The
/// vertical axis extends from 0 to a round number above all values of all curves, which is at least
/// `least` and has the unit `unit`. A line marks zero. The horizontal axis is the time, and its
/// right end is the present.
[[nodiscard]] cv::Mat drawRecentPlot(const ForceHistory& history, double least,
                                     const std::string& unit, std::span<const Curve> curves,
                                     cv::Size size);

}  // namespace hapticast::client
