// SPDX-License-Identifier: MIT
#include "client/view/touch_picture.hpp"

#include "client/view/painter.hpp"

namespace hapticast::client {

namespace {

const cv::Rect kPictureRoom(0, 44, 900, 506);
constexpr int kColumn_px = 924;  // left edge of the legend
constexpr int kLegendLine_px = 30;

void drawColumn(cv::Mat& image, const TickReport& report) {
  drawLabel(image, cv::format("%.2f N", report.force_N.norm()), {kColumn_px, 100}, kForceColor,
            1.4);
  drawLabel(image, "force at the device", {kColumn_px, 130}, kForceColor, 0.6);
  drawLabel(image, cv::format("%.2f mm deep", report.penetration_mm), {kColumn_px, 172}, kTextColor,
            0.6);
  int row_px = 250;
  for (const Legend& mark : kLegend) {
    if (mark.of_pointer) continue;
    drawLabel(image, mark.text, {kColumn_px, row_px}, mark.color, 0.55);
    row_px += kLegendLine_px;
  }
}

}  // namespace

cv::Mat drawTouchPicture(const cv::Mat& picture, const TickReport& report,
                         const Workspace& workspace, const std::string& caption,
                         const cv::Mat& plot) {
  cv::Mat image(kTouchPicture_px, CV_8UC3, kGroundColor);
  const ScenePlace place(workspace, {kPictureRoom.x, kPictureRoom.y},
                         {kPictureRoom.width, kPictureRoom.height});
  const cv::Point corner(cvRound(place.corner().x()), cvRound(place.corner().y()));
  const cv::Size size(cvRound(place.size().x()), cvRound(place.size().y()));
  fitPicture(picture, size).copyTo(image(cv::Rect(corner, size)));
  drawTouch(image, place, report);
  drawLabel(image, caption, {16, 30}, kTextColor, 0.75);
  drawLabel(image, "hapticast", {kColumn_px, 30}, kTextColor, 0.75);
  drawColumn(image, report);
  plot.copyTo(image.rowRange(image.rows - plot.rows, image.rows));
  return image;
}

}  // namespace hapticast::client
