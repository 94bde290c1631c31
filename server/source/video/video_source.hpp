// SPDX-License-Identifier: MIT
// What all sources from video files share: they leave out damaged frames, report them once, and
// begin again. Thread: one.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <string>

#include "server/source/picture/image_file.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/video/video_file.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Source whose frames come from video files. A subclass opens the files, sets `code_` and calls
/// describe().
class VideoSource : public RgbdSource {
 public:
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame. Throws SourceError if no frame of the whole clip is readable, because
  /// the files vanished or changed.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 protected:
  /// Moves to the next frame; `next_` is still its number. Returns false at the end. Throws
  /// SourceError if there is no first frame.
  virtual bool grabFrame() = 0;
  /// Returns the frame: colour as CV_8UC3, and depth as the file has it, or as CV_32FC1 in mm. A
  /// picture is empty if it is damaged. Returns "", or another problem of the frame, as a phrase.
  virtual std::string retrieveFrame(cv::Mat& color, cv::Mat& depth) = 0;
  /// Opens the files again, at their first frame.
  virtual void open() = 0;
  /// Returns the time of the frame that grabFrame() moved to, s.
  [[nodiscard]] virtual double clipTime_s() const;
  /// Returns the name of the file with depth or colour, for messages.
  [[nodiscard]] virtual const std::string& fileOf(bool depth) const = 0;

  [[nodiscard]] std::uint64_t next() const { return next_; }
  /// Sets the sizes and the kind of depth from the first frame, and logs if depth is scaled. `fps`
  /// > 0 overrides the rate of `track`. Throws SourceError if the pictures cannot be a source.
  void describe(const cv::Mat& color, const cv::Mat& raw, const VideoTrack& track, double fps);

  SourceInfo info_;
  DepthCode code_ = DepthCode::kGrey;
  DepthFormat format_;
  bool cut_reported_ = false;  // whether a warning of a clip that ends early was logged
  cv::Size color_size_;        // sizes of the pictures in the files
  cv::Size depth_size_;

 private:
  bool grab();
  /// Fills in pictures of `frame`. Returns the problem with the file's name, or "".
  std::string load(RgbdFrame& frame);

  /// Returns whether a run of unusable frames, from number `first_bad` on, deserves a warning.
  bool isNewFault(std::uint64_t first_bad);

  std::uint64_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool ended_ = false;
  bool any_read_ = false;  // whether a frame was read since the clip's start
  // First frame of each run of unusable frames whose warning was logged.
  std::set<std::uint64_t> reported_;
  std::uint64_t faults_ = 0;  // runs of unusable frames of a live source
};

/// Throws SourceError if `track` of `file` is too large to be a source.
void requireVideoSize(const VideoTrack& track, const std::string& file);

/// Throws SourceError if the values of `track` are no depth: more than 8 bits, but not grey.
void requireDepthFormat(const VideoTrack& track, const std::string& file);

/// Returns whether a video with the first frame `depth` has depth in mm.
[[nodiscard]] bool isMetric(const cv::Mat& depth);

}  // namespace hapticast::server
