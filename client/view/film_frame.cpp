// SPDX-License-Identifier: MIT
#include "client/view/film_frame.hpp"

#include <array>
#include <utility>

#include "client/view/painter.hpp"

namespace hapticast::client {

namespace {

const cv::Rect kPictureRoom(0, 44, 900, 506);
const cv::Rect kPlotRoom(0, 556, 1280, 164);
constexpr int kColumn_px = 924;  // left edge of the legend
constexpr int kLegendLine_px = 30;

void drawColumn(cv::Mat& frame, const TickReport& report) {
  drawLabel(frame, cv::format("%.2f N", report.force_N.norm()), {kColumn_px, 100}, kForceColor,
            1.4);
  drawLabel(frame, "force at the device", {kColumn_px, 130}, kForceColor, 0.6);
  drawLabel(frame, cv::format("%.2f mm deep", report.penetration_mm), {kColumn_px, 172}, kTextColor,
            0.6);
  const std::array<std::pair<const char*, cv::Scalar>, 6> lines{
      {{"yellow arrow: force at the device", kForceColor},
       {"dashed: its static share", kStaticForceColor},
       {"dashed: its dynamic share", kDynamicForceColor},
       {"ring: contact", kContactColor},
       {"cone: its tip is the hand", kConeColor},
       {"line: height above the object", kGapColor}}};
  int row_px = 250;
  for (const auto& [text, color] : lines) {
    drawLabel(frame, text, {kColumn_px, row_px}, color, 0.55);
    row_px += kLegendLine_px;
  }
}

}  // namespace

std::string filmCaption(const TickReport& report) {
  if (report.force_N != Vec3::Zero())
    return cv::format("The object pushes the hand with %.1f N.", report.force_N.norm());
  if (report.contact) return "The hand is in the object; the force has not come yet.";
  const auto gap_mm = surfaceGap_mm(report);
  return gap_mm ? cv::format("The hand is %.0f mm above the object.", *gap_mm)
                : "The hand is beside the object.";
}

cv::Mat drawFilmFrame(const cv::Mat& picture, const TickReport& report, const Workspace& workspace,
                      const ForceHistory& history, double top_N) {
  cv::Mat frame(kFilmSize_px, CV_8UC3, kGroundColor);
  const ScenePlace place(workspace, {kPictureRoom.x, kPictureRoom.y},
                         {kPictureRoom.width, kPictureRoom.height});
  const cv::Point corner(cvRound(place.corner().x()), cvRound(place.corner().y()));
  const cv::Size size(cvRound(place.size().x()), cvRound(place.size().y()));
  fitPicture(picture, size).copyTo(frame(cv::Rect(corner, size)));
  drawTouch(frame, place, report);
  drawLabel(frame, filmCaption(report), {16, 30}, kTextColor, 0.75);
  drawLabel(frame, "hapticast", {kColumn_px, 30}, kTextColor, 0.75);
  drawColumn(frame, report);
  const std::array<Curve, 3> curves{{{&ForcePoint::dynamic_force_N, kDynamicForceColor, "dynamic"},
                                     {&ForcePoint::static_force_N, kStaticForceColor, "static"},
                                     {&ForcePoint::force_N, kForceColor, "force at the device"}}};
  drawRecentPlot(history, top_N, "N", curves, kPlotRoom.size()).copyTo(frame(kPlotRoom));
  return frame;
}

}  // namespace hapticast::client
