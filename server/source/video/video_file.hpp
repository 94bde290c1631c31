// SPDX-License-Identifier: MIT
// Reads the pictures of video files and network streams, with FFmpeg's libraries. It reads the file
// once for all of its tracks. Files come from outside, so it limits sizes, the number of tracks and
// the number of waiting packets. Thread: one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/source/video/video_input.hpp"

namespace hapticast::server {

/// Facts about one video track.
struct VideoTrack {
  int width_px = 0;  ///< as shown, after the rotation that the file states
  int height_px = 0;
  double fps = 0.0;               ///< frames/s; 0: the file does not state it
  std::uint64_t frame_count = 0;  ///< 0: the file does not state it
  std::string format;             ///< FFmpeg's name of the pixel format, for example "gray16le"
  int bits = 8;                   ///< bits of a sample
  bool grey = false;              ///< whether the format has grey values only
  bool depth_name = false;        ///< whether the track's title or handler has the word depth
  bool kinect_depth = false;      ///< whether it is the depth track of an Azure Kinect or Orbbec
  bool operator==(const VideoTrack&) const = default;
};

/// Open video file or stream. Its tracks are numbered from 0, in the file's order.
class VideoFile {
 public:
  /// Opens `file` and reads its header. Throws NoVideoError if it has no video track that can
  /// be decoded. Throws SourceError if it is no file, a playlist, or has more than 16 tracks.
  explicit VideoFile(std::string file);
  /// Connects to `stream` and reads as much as its description needs. Throws as for a file. Throws
  /// SourceError also if it cannot be reached, or if it is a recorded file.
  explicit VideoFile(NetworkStream stream);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// Returns the path of the file, or the name of the stream.
  [[nodiscard]] const std::string& file() const;
  /// Returns whether it is a stream, which can be read only once.
  [[nodiscard]] bool isLive() const;
  [[nodiscard]] const std::vector<VideoTrack>& tracks() const;
  /// Returns the bytes of the file that is attached under `name`; "" if there is none.
  [[nodiscard]] std::string attachment(const std::string& name) const;
  /// Reads the whole file without decoding. Returns the times of all frames of `track`, s, on the
  /// clock that all tracks share, ascending. Returns an empty vector if the file does not state the
  /// time of each frame, or if it has more than 4 million. Nothing can be decoded afterwards.
  [[nodiscard]] std::vector<double> readTimes(std::size_t track);
  /// Begins to decode `track`, before its first grab(). Throws SourceError if that is impossible.
  void start(std::size_t track);
  /// Moves `track` to its next frame. Returns false at its end. A damaged frame counts as a frame.
  /// Throws SourceError if too many packets of another started track wait.
  bool grab(std::size_t track);
  /// Returns the time of the frame of `track`, s, on the clock that all tracks share. Negative
  /// infinity: the file states no time.
  [[nodiscard]] double time_s(std::size_t track) const;
  /// Returns the frame of `track` as new CV_8UC3 (BGR); empty if it is damaged.
  [[nodiscard]] cv::Mat retrieveColor(std::size_t track);
  /// Returns the frame of `track` as depth: new CV_16UC1 with the values of the file if the format
  /// is grey with more than 8 bits, else as retrieveColor(). Empty if it is damaged.
  [[nodiscard]] cv::Mat retrieveDepth(std::size_t track);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace hapticast::server
