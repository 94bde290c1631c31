// SPDX-License-Identifier: MIT
// Source from two video files: colour, and 8-bit grey depth (near is white). Thread: one.
#pragma once

#include <cstdint>
#include <opencv2/videoio.hpp>
#include <optional>
#include <set>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Source whose frames are those of the two files.
class VideoPair final : public RgbdSource {
 public:
  /// Opens both files and decodes their first frames. `fps` > 0 overrides the colour video's rate,
  /// frames/s. Throws SourceError if the files' sizes differ, or if their frame counts differ by
  /// more than five. It also throws if both are one file, and for depth with more than 8 bits per
  /// sample, which OpenCV 4.6 decodes wrongly without an error.
  VideoPair(std::string color_file, std::string depth_file, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame; the clip ends with the shorter file. Throws SourceError if no frame of
  /// the whole clip is readable, because the files vanished or changed.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  void open();
  /// Logs a warning if the two files state different frame rates.
  void warnOfOtherRate() const;
  /// Returns the number of frames of the shorter file; nullopt if a file does not state its number.
  /// Throws SourceError if the numbers differ by more than five.
  [[nodiscard]] std::optional<std::uint64_t> countFrames() const;
  /// Moves both files to the next frame. Returns false at the end of either. Throws SourceError if
  /// there is no first frame.
  bool grab();

  std::string color_file_;
  std::string depth_file_;
  SourceInfo info_;
  cv::VideoCapture color_;
  cv::VideoCapture depth_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool ended_ = false;
  bool any_read_ = false;  // whether a frame was read since the clip's start
  bool cut_reported_ = false;
  // First frame of each run of unusable frames whose warning was logged.
  std::set<std::uint64_t> reported_;
};

/// Returns whether a pixel format is known to have at most 8 bits per sample. `tag`: FFmpeg's tag
/// of raw video, from CAP_PROP_CODEC_PIXEL_FORMAT.
[[nodiscard]] bool isEightBitFormat(std::uint32_t tag);

}  // namespace hapticast::server
