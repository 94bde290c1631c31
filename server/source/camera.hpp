// SPDX-License-Identifier: MIT
// Two cameras as a live source: one gives colour, the other depth of the same size, registered to
// it. Thread: one.
#pragma once

#include <memory>
#include <opencv2/videoio.hpp>
#include <string>

#include "server/source/image_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// An open capture, and what to call it to people.
struct CameraDevice {
  std::unique_ptr<cv::VideoCapture> capture;
  std::string name;
};

class Camera final : public RgbdSource {
 public:
  /// Opens /dev/video`color` and /dev/video`depth`, takes a frame of each. 16-bit depth is taken as
  /// mm, 8-bit depth as height (near is white). `fps` > 0 is asked of the devices. Throws
  /// SourceError.
  Camera(int color, int depth, double fps);
  /// The same with captures that are open.
  Camera(CameraDevice color, CameraDevice depth, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Waits for the next frame of both. Throws SourceError when a device gives no more, or for about
  /// a second nothing that can be used: pictures of another size, for example.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  /// Throws: what is live cannot be rewound.
  void rewind() override;

 private:
  void grab();
  /// The picture just grabbed; what is wrong with it, or "".
  std::string retrieve(const CameraDevice& device, cv::Mat& picture) const;

  CameraDevice color_;
  CameraDevice depth_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
  std::uint64_t faults_ = 0;  // how often frames were left out
};

}  // namespace hapticast::server
