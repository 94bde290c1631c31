// SPDX-License-Identifier: MIT
#include "client/view/screenshot.hpp"

#include <stdexcept>
#include <utility>

#include "client/view/picture.hpp"
#include "client/view/status.hpp"
#include "client/view/touch_picture.hpp"

namespace hapticast::client {

namespace {

/// Rank of a moment: a contact ranks above the release ramp after it.
double computeStrength(const TickReport& report) {
  return report.contact ? 1.0 + report.force_N.norm() : 0.0;
}

}  // namespace

void Screenshot::onPicture(VideoFrame picture, const Workspace& workspace) {
  pictures_.add(std::move(picture), workspace);
}

void Screenshot::onReport(const TickReport& report) {
  history_.add(report);
  if (computeStrength(moment_) > 0.0 && computeStrength(report) <= computeStrength(moment_)) return;
  moment_ = report;
  picture_.reset();
}

bool Screenshot::update(UiState& ui_state) {
  user_ = ui_state.user;
  findPicture();
  return true;
}

void Screenshot::findPicture() {
  if (!picture_) picture_ = pictures_.findNearest(moment_.play_time);
}

void Screenshot::finish() {
  findPicture();
  cv::Mat picture;
  Workspace workspace;  // without a picture: the nominal workspace
  if (picture_) {
    workspace = picture_->workspace;
    picture = decodeJpeg(picture_->video.jpeg, {workspace.width_px, workspace.height_px});
  }
  const cv::Mat plot = drawForcePlot(history_, toSeconds(moment_.time), kTouchPlot_px);
  const auto error = writePicture(
      file_, drawTouchPicture(picture, moment_, workspace, touchLine(moment_, user_), plot));
  if (error) throw std::runtime_error("--screenshot " + file_ + ": " + error->message);
}

}  // namespace hapticast::client
