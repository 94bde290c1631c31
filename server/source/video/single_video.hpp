// SPDX-License-Identifier: MIT
// Source from one video file that holds colour and depth: as two tracks, or as the halves of one
// picture. Thread: one.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "server/source/picture/depth_registration.hpp"
#include "server/source/video/video_file.hpp"
#include "server/source/video/video_source.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Source whose frames are those of one file.
class SingleVideo final : public VideoSource {
 public:
  /// Decodes the first frame of `video`, of which no track has started. `fps` > 0 overrides the
  /// rate of the colour, frames/s. With Layout::kSeparate the depth is the track of an Azure
  /// Kinect's depth, else the one whose title has the word depth, else the only grey one. Its
  /// frames belong to the colour frames that are nearest in time. Throws SourceError. For one track
  /// without a layout the error says what the picture looks like. Of a stream the source begins
  /// with the second frame, it cannot be rewound, and RgbdFrame::clip_time_s is the stream's own
  /// time.
  SingleVideo(std::unique_ptr<VideoFile> video, const VideoLayout& layout, double fps);

 private:
  bool grabFrame() override;
  std::string retrieveFrame(cv::Mat& color, cv::Mat& depth) override;
  void open() override;
  [[nodiscard]] double clipTime_s() const override;
  [[nodiscard]] const std::string& fileOf(bool) const override { return file_; }
  /// Chooses the tracks. Throws SourceError if they are not clear.
  void chooseTracks();
  /// Throws SourceError that says what the file with a single track looks like.
  [[noreturn]] void throwOneTrack();
  /// Starts the chosen tracks of the open file.
  void startTracks();
  /// Prepares the registration of a Kinect's depth from its attached calibration. Logs a warning if
  /// that is impossible. Throws SourceError if the calibration is damaged.
  void prepareRegistration();
  /// Throws SourceError if the pictures are too large.
  void requireSizes() const;
  /// Moves the depth to the frame of the colour's time. Returns false at the end of the depth.
  bool followColor();

  std::string file_;
  Layout layout_;
  std::unique_ptr<VideoFile> video_;
  std::size_t color_ = 0;
  std::size_t depth_ = 0;
  double color_time_s_ = -std::numeric_limits<double>::infinity();  // latest so far
  bool depth_grabbed_ = false;                                      // whether the depth has a frame
  std::optional<DepthRegistration> registration_;                   // nullopt: aligned already
  std::optional<CameraModel> camera_;                               // of the colour, if known
  std::string problem_;  // problem of the frame's time; "" if depth belongs to colour
};

}  // namespace hapticast::server
