// SPDX-License-Identifier: MIT
// Source from a colour video and a sequence of depth pictures: frame n has picture n. Thread: one.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/source/camera_model.hpp"
#include "server/source/picture/depth_sequence.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/skipped_frames.hpp"
#include "server/source/video/video_file.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// What is known about a colour video and its depth.
struct VideoDepthFacts {
  std::string name;                   ///< name for people
  double fps = 0.0;                   ///< rate, frames/s; 0: that of the video
  VideoLayout layout;                 ///< its code and its unit of depth
  std::optional<double> mm_per_unit;  ///< stated unit; nullopt: 1 for integers, 1000 for floats
  std::optional<CameraModel> camera;  ///< of the pictures of the video
  std::optional<double> fov_deg;      ///< horizontal field of view, if the camera is not known
};

/// Source whose colour is a video. A frame without a picture of depth is left out.
class VideoWithDepth final : public RgbdSource {
 public:
  /// Decodes the first picture of both. No track of `video` may have started; its first track is
  /// the colour. The clip ends with the shorter one. Throws SourceError if the aspect ratios
  /// differ, if the lengths differ by more than five frames, or if the depth is in false colours
  /// and the code is not kHue.
  VideoWithDepth(std::unique_ptr<VideoFile> video, std::unique_ptr<DepthSequence> depth,
                 VideoDepthFacts facts);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame. Throws SourceError if no frame of the whole clip is readable.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Sets the sizes and the kind of depth from the first pictures. Throws SourceError.
  void describe(const cv::Mat& color, const cv::Mat& raw, const std::string& depth_name);
  /// Returns the number of frames. Throws SourceError if those of colour and depth differ by more
  /// than five.
  [[nodiscard]] std::uint64_t countFrames() const;
  /// Moves the video to its next frame. Returns false at the end of the clip, and logs once if the
  /// depth ends before the colour.
  bool grab();
  /// Sets the pictures of `frame`. Returns the problem with the file's name, or "".
  std::string load(RgbdFrame& frame);

  std::unique_ptr<VideoFile> video_;
  std::unique_ptr<DepthSequence> depth_;
  VideoDepthFacts facts_;
  SourceInfo info_;
  DepthFormat format_;
  cv::Size color_size_;  // sizes of the pictures in the files
  cv::Size depth_size_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool any_read_ = false;      // whether a frame was read since the clip's start
  bool cut_reported_ = false;  // whether it was logged that the depth ends early
  SkippedFrames skipped_;
};

}  // namespace hapticast::server
