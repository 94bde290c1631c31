// SPDX-License-Identifier: MIT
// Source interface: RGB-D frames (colour plus registered depth) from a clip or a camera. One
// interface, with one implementation for each kind. Thread: one for each source.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "server/source/camera_model.hpp"

namespace hapticast::server {

/// Meaning of the values of RgbdFrame::depth.
enum class DepthKind : std::uint8_t {
  kMetric,  ///< mm along the optical axis, 0: no measurement
  kHeight,  ///< 0..255, 255: nearest, all valid (8-bit depth)
};

/// Constant properties of a source.
struct SourceInfo {
  std::string name;  ///< for people, also sent to viewers: without a path
  int width_px = 0;
  int height_px = 0;
  double fps = 25.0;
  DepthKind depth_kind = DepthKind::kMetric;
  bool live = false;       ///< cannot be scanned or rewound
  bool key_masks = false;  ///< masks are the author's key masks of a few frames
  std::optional<std::uint64_t> frame_count;
  /// The source's own range for the whole clip, if any.
  std::optional<DepthRange> depth_range;
  std::optional<CameraModel> camera;
};

/// One frame. Its images are read-only for all code: a source makes new ones for each frame and
/// never writes to them again, so that code shares them without copies.
struct RgbdFrame {
  std::uint64_t index = 0;   ///< frame number in the clip; skipped frames count
  std::uint32_t epoch = 0;   ///< incremented at every loop wrap
  double clip_time_s = 0.0;  ///< since the clip's start, s
  cv::Mat color;             ///< CV_8UC3, BGR
  cv::Mat depth;             ///< CV_32FC1, same size; see DepthKind
  /// Empty, or CV_8UC1: 0 outside, n for object n. With SourceInfo::key_masks most frames have
  /// none, and each mask shows at least one object.
  cv::Mat mask;
};

/// A problem with the source that its user must fix. what() is one line with the file and the
/// remedy.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A source of frames. Thread: one.
class RgbdSource {
 public:
  virtual ~RgbdSource() = default;
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// Returns the next frame, nullopt at the end of the clip. Skips unreadable frames with one
  /// warning. Throws SourceError if no further frame is available.
  virtual std::optional<RgbdFrame> read() = 0;
  /// Skips the next frame, without decoding if possible. Returns false at the end.
  virtual bool skip() = 0;
  /// Returns to the first frame (epoch + 1). Throws SourceError on a live source.
  virtual void rewind() = 0;
};

/// Returns the last part of a path, the only part that viewers receive.
std::string fileName(const std::filesystem::path& path);

/// Opens the source of --source: synthetic:NAME, DIR, COLOR,DEPTH or camera:N,M. `fps` > 0
/// overrides its rate. Throws SourceError.
std::unique_ptr<RgbdSource> openSource(const std::string& spec, double fps);

}  // namespace hapticast::server
