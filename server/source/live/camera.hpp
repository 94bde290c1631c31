// SPDX-License-Identifier: MIT
// Live source from two V4L2 cameras: one for colour, one for depth. Their pictures have the same
// size. Depth is registered to colour: one pixel of both shows the same point. Thread: one.
#pragma once

#include <memory>
#include <opencv2/videoio.hpp>
#include <string>

#include "server/source/picture/image_file.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// An open capture device, with its name for messages.
struct CameraDevice {
  std::unique_ptr<cv::VideoCapture> capture;
  std::string name;
};

/// Source whose frames are those of the two cameras.
class Camera final : public RgbdSource {
 public:
  /// Opens /dev/video`color` and /dev/video`depth` and reads one frame of each. 16-bit depth is in
  /// mm. 8-bit depth is height: near is white. `fps` > 0: rate that the cameras are asked for,
  /// frames/s. Throws SourceError.
  Camera(int color, int depth, double fps);
  /// Creates the source from captures that are open already.
  Camera(CameraDevice color, CameraDevice depth, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Waits for the next frame of both cameras and returns it. Throws SourceError if a device fails,
  /// or after 25 unusable frames in a row (about a second). A frame is unusable, for example, if
  /// its picture has another size.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  /// Always throws SourceError, because a live source cannot be rewound.
  void rewind() override;

 private:
  void grab();
  /// Decodes the last picture of `device` into `picture`. Returns the problem, or "" on success.
  std::string retrieve(const CameraDevice& device, cv::Mat& picture) const;

  CameraDevice color_;
  CameraDevice depth_;
  SourceInfo info_;
  DepthFormat format_;
  std::uint64_t next_ = 0;
  std::uint64_t faults_ = 0;  // how often a run of frames was omitted
};

}  // namespace hapticast::server
