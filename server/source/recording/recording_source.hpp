// SPDX-License-Identifier: MIT
// Source from a recording (MCAP) of another program: a topic of colour images and one of depth, in
// messages of ROS 2 or Foxglove. It is read once at the start for the times of all images. Later
// each frame is read from its place, so a file may be larger than the memory. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/recording/mcap_reader.hpp"
#include "server/source/recording/image_pairs.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/source/skipped_frames.hpp"

namespace hapticast::server {

/// Returns whether `file` is a recording: its name ends with .mcap, or its first bytes are those of
/// MCAP.
[[nodiscard]] bool isRecordingFile(const std::string& file);

/// Returns the recording in `folder` if that is a ROS 2 bag, which has metadata.yaml: the MCAP
/// file, else a file of another form, which refuseKnownFile() explains. Returns "" if it is no bag.
/// Throws SourceError if the bag has several MCAP files.
[[nodiscard]] std::string findBagFile(const std::string& folder);

/// Source whose frames are pairs of messages.
class RecordingSource final : public RgbdSource {
 public:
  /// Opens `file`. `fps` > 0 overrides the rate of the stamps, frames/s. `layout`: its topics and
  /// its unit of depth. Throws SourceError.
  RecordingSource(const std::string& file, double fps, const VideoLayout& layout);

  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  /// Returns the next frame. RgbdFrame::index has gaps where images are missing. Throws SourceError
  /// if no frame of the whole clip is readable.
  std::optional<RgbdFrame> read() override;
  bool skip() override;
  void rewind() override;

 private:
  /// Images of one topic. Each topic has a reader of its own, so that each reads forwards.
  struct Track {
    McapReader reader;
    std::string name;  ///< file and topic, for messages
  };
  /// Opens the file once more for the images of `topic`, without reading its index again. The
  /// reader stands at the begin of the file. Throws SourceError.
  [[nodiscard]] Track openTrack(const McapReader& reader, const ImageTopic& topic) const;
  /// Returns the picture of `track` at `place`, as read by `decode`, or its problem.
  [[nodiscard]] static ImageResult readAt(Track& track, McapPlace place,
                                          ImageResult (*decode)(const ImageMessage&));
  /// Sets the sizes and the unit of depth from the first pair with two readable pictures. Throws
  /// SourceError.
  void describe(const VideoLayout& layout);
  void setCamera(const CameraMessage& camera);
  /// Sets the pictures of `frame`. Returns the problem with its topic, or "".
  [[nodiscard]] std::string load(RgbdFrame& frame);

  std::string file_;
  RecordedPairs clip_;
  std::optional<Track> color_, depth_;
  SourceInfo info_;
  DepthFormat format_;
  cv::Size color_size_;  // sizes of the pictures in the file
  cv::Size depth_size_;
  std::size_t next_ = 0;
  std::uint32_t epoch_ = 0;
  bool any_read_ = false;  // whether a frame was read since the clip's start
  SkippedFrames skipped_;
};

}  // namespace hapticast::server
