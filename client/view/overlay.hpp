// SPDX-License-Identifier: MIT
// The viewer's picture: the video with the HIP's cone and the force arrow, and the force over time
// below it. Drawn off screen; a window shows the same picture. Thread: one.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

class Overlay {
 public:
  /// Adds a tick to the force plot (a new point every kPlotStep ticks; peaks are kept).
  void add(const TickReport& report);

  /// Draws `report` over `picture` (CV_8UC3 of the same play time; empty: a dark ground of the
  /// workspace's size). The plot shows all ticks added so far and marks the moment of `report`.
  [[nodiscard]] cv::Mat draw(const cv::Mat& picture, const TickReport& report,
                             const Workspace& workspace) const;

 private:
  struct PlotPoint {
    double time_s = 0.0;
    double force_N = 0.0;  // largest magnitudes of the ticks it stands for
    double static_force_N = 0.0;
    double dynamic_force_N = 0.0;
    bool contact = false;
  };
  static constexpr std::size_t kPlotStep = 5;  // ticks a plot point stands for

  void drawPlot(cv::Mat canvas, double marked_s) const;

  std::vector<PlotPoint> points_;
  std::size_t ticks_in_point_ = 0;
};

}  // namespace hapticast::client
