// SPDX-License-Identifier: MIT
// Live source from a camera that delivers colour and depth as separate pictures. A colour and a
// depth picture form a frame if their capture times differ by at most half a frame. Thread: one.
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// One picture of a camera.
struct LivePicture {
  bool is_depth = false;
  LocalTime time{};     ///< when the picture was captured or arrived
  cv::Mat image;        ///< colour: CV_8UC3, BGR; depth: CV_32FC1; empty if there is a problem
  std::string problem;  ///< why the picture is unusable, with the name of the camera; else empty
};

/// An open camera that delivers pictures of colour and of depth. The caller owns their images.
/// Thread: one.
class PictureCamera {
 public:
  virtual ~PictureCamera() = default;
  /// As LiveDevice::info(). The size is that of the colour.
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns whether the camera delivers depth. Without depth each colour picture is a frame.
  [[nodiscard]] virtual bool hasDepth() const { return true; }
  /// As LiveDevice::warnings().
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
  /// Waits for the next picture, at most `longest`, and returns it. Returns nullopt if no picture
  /// arrived. Skips a picture if a newer one of the same kind has arrived. Throws SourceError if
  /// the camera is lost.
  virtual std::optional<LivePicture> read(Duration longest) = 0;
};

/// Colour and depth of one moment.
struct LivePair {
  cv::Mat color;
  cv::Mat depth;
  LocalTime time{};  ///< that of the colour
};

/// Pairs pictures of colour with pictures of depth by their times. Thread: one.
class PicturePairer {
 public:
  /// `fps`: frames/s of the colour; a pair is at most half a frame apart.
  explicit PicturePairer(double fps);

  /// Adds a picture. Returns it with the last picture of the other kind if both form a pair. No
  /// picture is in two pairs.
  std::optional<LivePair> push(LivePicture picture);

 private:
  Duration longest_apart_;
  std::optional<LivePicture> color_;
  std::optional<LivePicture> depth_;
};

/// Opens a camera with `open`, waits for its first frame, at most 5 s, and returns the source. A
/// camera without a frame for a second counts as lost. Smaller depth of the same aspect ratio is
/// scaled to the size of the colour. Throws SourceError, also if there is no frame.
std::unique_ptr<RgbdSource> openPairedCamera(std::function<std::unique_ptr<PictureCamera>()> open);

}  // namespace hapticast::server
