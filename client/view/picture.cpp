// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <turbojpeg.h>
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include "common/media/load_media_module.hpp"
#include "common/write_file.hpp"

namespace hapticast::client {

namespace {

using Decompressor = std::unique_ptr<void, decltype(&tjDestroy)>;

}  // namespace

BgrPixels viewPixels(const cv::Mat& picture) {
  return {picture.data, picture.cols, picture.rows, static_cast<std::ptrdiff_t>(picture.step[0])};
}

cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected) {
  if (expected.empty() || jpeg.empty()) return {};
  const Decompressor decompressor(tjInitDecompress(), &tjDestroy);
  cv::Size announced;
  int subsampling = 0;
  int color_space = 0;
  if (!decompressor ||
      tjDecompressHeader3(decompressor.get(), jpeg.data(), jpeg.size(), &announced.width,
                          &announced.height, &subsampling, &color_space) != 0 ||
      announced != expected) {
    return {};
  }
  cv::Mat picture(expected, CV_8UC3);
  // The decoder fills missing parts with grey and only warns. A progressive JPEG of a few bytes
  // could request any number of scans of the whole picture.
  constexpr int kFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  const int failed =
      tjDecompress2(decompressor.get(), jpeg.data(), jpeg.size(), picture.data, expected.width,
                    static_cast<int>(picture.step), expected.height, TJPF_BGR, kFlags);
  return failed == 0 ? picture : cv::Mat();
}

std::optional<Error> writePicture(const std::string& file, const cv::Mat& picture) {
  if (picture.empty()) return Error{"no picture to write"};
  try {
    return writeFile(file, loadMediaModule().encodePng(viewPixels(picture)));
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
}

void PictureBuffer::add(VideoFrame video, const Workspace& workspace) {
  const std::size_t size = video.jpeg.size();
  auto picture = std::make_shared<const StreamPicture>(StreamPicture{std::move(video), workspace});
  const std::lock_guard lock(mutex_);
  if (!pictures_.empty() && picture->video.media_time < pictures_.back()->video.media_time) {
    pictures_.clear();
    bytes_ = 0;
  }
  pictures_.push_back(std::move(picture));
  bytes_ += size;
  while (pictures_.size() > kMaxPictures || (bytes_ > kMaxBytes && pictures_.size() > 1)) {
    bytes_ -= pictures_.front()->video.jpeg.size();
    pictures_.pop_front();
  }
}

std::shared_ptr<const StreamPicture> PictureBuffer::findNearest(MediaTime time) const {
  const auto distance = [time](const auto& picture) {
    return std::abs((picture->video.media_time - time).count());
  };
  const std::lock_guard lock(mutex_);
  const auto found =
      std::min_element(pictures_.begin(), pictures_.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  return found == pictures_.end() ? nullptr : *found;
}

}  // namespace hapticast::client
