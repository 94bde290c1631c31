// SPDX-License-Identifier: MIT
// Interface of a source of RGB-D frames (colour and depth), such as a clip or a camera. Depth is
// registered to colour: one pixel of both shows the same point. There is one implementation for
// each kind of source. Thread: any; at most one at a time for each source.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "common/time.hpp"
#include "server/source/camera_model.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Meaning of the values of RgbdFrame::depth.
enum class DepthKind : std::uint8_t {
  kMetric,  ///< mm along the optical axis; 0: not measured
  kHeight,  ///< 8-bit depth: 0..255, 255 is nearest, all values are valid
};

/// Origin of the depth: a sensor, or a program that estimates it. An estimator's scale and shift
/// may differ from frame to frame.
enum class EstimatedDepth : std::uint8_t {
  kNone,      ///< measured
  kMetric,    ///< mm
  kRelative,  ///< depth with an unknown scale and shift
  kInverse,   ///< 1 / depth with an unknown scale and shift
};

/// Constant properties of a source.
struct SourceInfo {
  std::string name;  ///< name for people, which viewers receive too; without a path
  int width_px = 0;
  int height_px = 0;
  /// Pixels of the clip's own pictures for each pixel of the frames, in u and v, 1 or more. A
  /// source scales larger pictures down. The author's points count in the own pictures.
  Vec2 own_px = Vec2::Ones();
  double fps = 25.0;
  DepthKind depth_kind = DepthKind::kMetric;
  double mm_per_unit = 1.0;  ///< mm of one unit of depth in the files; only with kMetric
  bool live = false;         ///< true: a camera or stream, which cannot be scanned or rewound
  bool key_masks = false;    ///< true: the masks are the author's key masks of a few frames
  EstimatedDepth estimated = EstimatedDepth::kNone;
  std::optional<std::uint64_t> frame_count;
  /// Range of depths that the source states for the whole clip; nullopt: it states none.
  std::optional<DepthRange> depth_range;
  std::optional<CameraModel> camera;
};

/// One frame of a source. Its images are read-only for all code: a source makes new ones for each
/// frame and never writes to them again. So stages can share them without copies.
struct RgbdFrame {
  std::uint64_t index = 0;  ///< number of the frame in the clip; skipped frames count too
  /// Incremented each time the clip begins again, or a live source after a gap.
  std::uint32_t epoch = 0;
  double clip_time_s = 0.0;  ///< time since the clip's start, s
  cv::Mat color;             ///< CV_8UC3, BGR
  /// CV_32FC1, same size; see DepthKind. Empty with VideoLayout::color_only.
  cv::Mat depth;
  /// Masks of the objects: empty, or CV_8UC1 with 0 outside and n for object n. If
  /// SourceInfo::key_masks is true, most frames have no mask, and each mask shows at least one
  /// object.
  cv::Mat mask;
  Duration age{};  ///< of a live source: time from the capture to the return of read()
};

/// Error: a source has a problem that the user must solve. what() is one line with the file and the
/// remedy.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Source of frames. Thread: one.
class RgbdSource {
 public:
  virtual ~RgbdSource() = default;
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns the next usable frame. Skips unusable frames, with one warning for each run of them.
  /// Returns nullopt at the end of the clip. Throws SourceError if the clip ends and no frame of
  /// this playback was usable, or if its files have vanished. A live source has no end: there
  /// nullopt means that no frame has arrived yet, so the caller asks again.
  virtual std::optional<RgbdFrame> read() = 0;
  /// Skips the next frame, without decoding it if possible. Returns false at the end of the clip.
  virtual bool skip() = 0;
  /// Begins the clip again: the next frame is the first one, with the epoch incremented. Throws
  /// SourceError if the source is live.
  virtual void rewind() = 0;
};

/// Returns the last part of a path. Viewers receive only this part.
std::string fileName(const std::filesystem::path& path);

/// Opens the source that `spec` names, the value of --source: synthetic:NAME, DIR, COLOR,DEPTH,
/// FILE (a video or a recording), camera:N,M, openni:DEVICE, v4l2:COLOR,DEPTH or the address of a
/// live stream. With VideoLayout::color_only also a folder of colour images, camera:N and
/// v4l2:COLOR. `fps` > 0 overrides its rate, frames/s. `to_and_fro`: the images of a folder play
/// forwards, then backwards. `layout`: place and code of the depth in videos. Throws SourceError,
/// also if this kind of source does not support an argument.
std::unique_ptr<RgbdSource> openSource(const std::string& spec, double fps, bool to_and_fro = false,
                                       const VideoLayout& layout = {});

}  // namespace hapticast::server
