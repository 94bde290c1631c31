// SPDX-License-Identifier: MIT
// Two video files as a source: colour, and 8-bit grey depth (near is white). Thread: one.
#pragma once

#include <opencv2/videoio.hpp>
#include <set>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

class VideoPair final : public RgbdSource {
 public:
  /// Opens both files and looks at their first frames. `fps` > 0 overrides the colour video's rate.
  /// Refuses depth of more than 8 bits per sample (OpenCV 4.6 would read it wrongly, without a
  /// word), different sizes, and frame counts further apart than a few. Throws SourceError.
  VideoPair(std::string color_file, std::string depth_file, double fps);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Ends with the shorter of the two. Throws SourceError where a round has no frame: the files
  /// have gone or are others.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  void open();
  /// Both at the next frame; false at the end of either. Throws SourceError where that is the
  /// first.
  bool grab();

  std::string color_file_;
  std::string depth_file_;
  SourceInfo info_;
  cv::VideoCapture color_;
  cv::VideoCapture depth_;
  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool ended_ = false;
  bool any_read_ = false;  // of this round
  bool cut_reported_ = false;
  std::set<std::uint64_t> reported_;  // frames that cannot be used, the first of each run
};

/// Whether a pixel format (CAP_PROP_CODEC_PIXEL_FORMAT: FFmpeg's tag of raw video) is known to have
/// at most 8 bits per sample.
[[nodiscard]] bool isEightBitFormat(std::uint32_t tag);

}  // namespace hapticast::server
