// SPDX-License-Identifier: MIT
// Source from two video files: colour, and grey depth. Depth of 8 bits is height (near is white).
// Depth of more bits is in mm. Thread: one.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "server/source/video/video_file.hpp"
#include "server/source/video/video_source.hpp"

namespace hapticast::server {

/// Source whose frames are those of the two files, paired by number.
class VideoPair final : public VideoSource {
 public:
  /// Opens both files and decodes their first frames. `fps` > 0 overrides the colour video's rate,
  /// frames/s. The clip ends with the shorter file. Throws SourceError if the files' aspect ratios
  /// differ, or if their frame counts differ by more than five. It also throws if both are one
  /// file, and for depth in colours that `code` does not explain.
  VideoPair(std::string color_file, std::string depth_file, double fps,
            DepthCode code = DepthCode::kGrey);

 private:
  bool grabFrame() override;
  std::string retrieveFrame(cv::Mat& color, cv::Mat& depth) override;
  void open() override;
  [[nodiscard]] const std::string& fileOf(bool depth) const override {
    return depth ? depth_file_ : color_file_;
  }
  /// Logs a warning if the two files state different frame rates.
  void warnOfOtherRate() const;
  /// Returns the number of frames of the shorter file; nullopt if a file does not state its number.
  /// Throws SourceError if the numbers differ by more than five.
  [[nodiscard]] std::optional<std::uint64_t> countFrames() const;

  std::string color_file_;
  std::string depth_file_;
  std::unique_ptr<VideoFile> color_;
  std::unique_ptr<VideoFile> depth_;
};

}  // namespace hapticast::server
