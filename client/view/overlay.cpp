// SPDX-License-Identifier: MIT
#include "client/view/overlay.hpp"

#include <cmath>
#include <string>

#include "client/view/painter.hpp"

namespace hapticast::client {

namespace {

constexpr int kPictureWidth_px = 960;
constexpr int kPlotHeight_px = 260;
// Area above the video: text, and a cone at the upper edge.
constexpr int kHeadHeight_px = 90;

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
  cv::Mat overlay(kHeadHeight_px + size.height + kPlotHeight_px, size.width, CV_8UC3, kGroundColor);
  fitPicture(picture, size).copyTo(overlay(cv::Rect({0, kHeadHeight_px}, size)));
  cv::Mat scene = overlay.rowRange(0, kHeadHeight_px + size.height);
  drawTouch(scene, {workspace, {0.0, kHeadHeight_px}, {size.width, size.height}}, report);
  drawLabel(scene, caption(report), {10, 18}, kTextColor);
  drawLegend(scene, {10, 38});
  drawForcePlot(history, toSeconds(report.time), {size.width, kPlotHeight_px})
      .copyTo(overlay.rowRange(scene.rows, overlay.rows));
  return overlay;
}

}  // namespace hapticast::client
