// SPDX-License-Identifier: MIT
// Two cameras as a live source: one gives colour, the other depth of the same size, registered to
// it. Thread: one.
#pragma once

#include <opencv2/videoio.hpp>
#include <string>

#include "server/source/image_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

class Camera final : public RgbdSource {
 public:
  /// Opens /dev/video`color` and /dev/video`depth`, takes a frame of each. 16-bit depth is taken as
  /// mm, 8-bit depth as height (near is white). `fps` > 0 is asked of the devices. Throws
  /// SourceError.
  Camera(int color, int depth, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Waits for the next frame of both. Throws SourceError when a device gives no more.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  /// Throws: what is live cannot be rewound.
  void rewind() override;

 private:
  void grab();

  std::string color_name_;
  std::string depth_name_;
  cv::VideoCapture color_;
  cv::VideoCapture depth_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
};

}  // namespace hapticast::server
