// SPDX-License-Identifier: MIT
#include "client/view/viewer.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <utility>

#include "client/view/picture.hpp"

namespace hapticast::client {

namespace {

/// How much a moment is worth showing: touching counts more than any residue.
double strength(const TickReport& report) {
  return report.contact ? 1.0 + report.force_N.norm() : 0.0;
}

}  // namespace

void Viewer::requirePictureName(const std::string& file) {
  if (!cv::haveImageWriter(file))
    throw std::runtime_error("--screenshot " + file + ": is no picture's name; give FILE.png");
}

void Viewer::take(VideoFrame picture) {
  const std::lock_guard lock(mutex_);
  pictures_.push_back(std::move(picture));
  if (pictures_.size() > kPictures) pictures_.pop_front();
}

void Viewer::add(const TickReport& report) {
  overlay_.add(report);
  // A new moment has to be clearly better, or every tick of a rising force would copy a picture.
  if (strength(report) > 1.02 * strength(strongest_) || !picture_) {
    strongest_ = report;
    picture_ = pictureAt(report.play_time);
  }
}

std::optional<VideoFrame> Viewer::pictureAt(MediaTime time) {
  const std::lock_guard lock(mutex_);
  const auto distance = [time](const VideoFrame& picture) {
    return std::abs((picture.media_time - time).count());
  };
  const auto nearest =
      std::min_element(pictures_.begin(), pictures_.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  if (nearest == pictures_.end()) return std::nullopt;
  return *nearest;
}

void Viewer::write(const std::string& file, const Workspace& workspace) const {
  cv::Mat picture;
  if (picture_) picture = decodeJpeg(picture_->jpeg, {workspace.width_px, workspace.height_px});
  bool written = false;
  try {
    written = cv::imwrite(file, overlay_.draw(picture, strongest_, workspace));
  } catch (const cv::Exception&) {
    written = false;  // for example an ending that is no image format
  }
  if (!written)
    throw std::runtime_error("--screenshot " + file +
                             ": cannot be written; is it FILE.png in a folder that exists?");
}

}  // namespace hapticast::client
