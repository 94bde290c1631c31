// SPDX-License-Identifier: MIT
// Camera whose pictures of colour and of depth come one by one: makes a live source of it. Two
// pictures that were captured at most half a frame apart are a frame.
// Thread: one.
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

/// An open camera that delivers pictures of colour and of depth, which belong to the caller.
/// Thread: one.
class PictureCamera {
 public:
  virtual ~PictureCamera() = default;
  /// As LiveDevice::info(). The size is that of the colour.
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// As LiveDevice::warnings().
  [[nodiscard]] virtual std::vector<std::string> warnings() const = 0;
  /// Waits for the next picture, at most `longest`, and returns it. Returns nullopt if none came.
  /// Leaves out pictures that are older than another one of the same kind. Throws SourceError if
  /// the camera is gone.
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

  /// Adds a picture. Returns it with the last one of the other kind if both are of one moment. No
  /// picture is in two pairs.
  std::optional<LivePair> push(LivePicture picture);

 private:
  Duration longest_apart_;
  std::optional<LivePicture> color_;
  std::optional<LivePicture> depth_;
};

/// Opens a camera with `open`, waits for its first frame, at most 5 s, and returns the source. A
/// camera without a frame for a second counts as gone. Smaller depth of the same aspect ratio is
/// scaled to the size of the colour. Throws SourceError, also if there is no frame.
std::unique_ptr<RgbdSource> openPairedCamera(std::function<std::unique_ptr<PictureCamera>()> open);

}  // namespace hapticast::server
