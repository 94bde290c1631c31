// SPDX-License-Identifier: MIT
// A source of colour plus depth frames. One interface, a file per kind.
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

/// What the values of RgbdFrame::depth mean.
enum class DepthKind : std::uint8_t {
  kMetric,  ///< mm from the camera along the optical axis, 0 = no measurement
  kHeight,  ///< 0..255, 255 is nearest, every value is a measurement (8-bit depth)
};

struct SourceInfo {
  std::string name;  ///< for people, also at the viewers' end: no path
  int width_px = 0;
  int height_px = 0;
  double fps = 25.0;
  DepthKind depth_kind = DepthKind::kMetric;
  bool live = false;       ///< cannot be scanned or rewound
  bool key_masks = false;  ///< masks are what the author drew in a few of the frames
  std::optional<std::uint64_t> frame_count;
  std::optional<DepthRange>
      depth_range;  ///< if the source itself knows its range for the whole clip
  std::optional<CameraModel> camera;
};

/// The pictures belong to whoever has the frame: a source makes new ones for each and never writes
/// into them again, and nobody else does either. So they are kept and handed on without copies.
struct RgbdFrame {
  std::uint64_t index = 0;   ///< frame number within the clip; skipped frames count
  std::uint32_t epoch = 0;   ///< +1 at every loop wrap
  double clip_time_s = 0.0;  ///< since the clip's start
  cv::Mat color;             ///< CV_8UC3, BGR
  cv::Mat depth;             ///< CV_32FC1, same size; see DepthKind
  /// Empty, or CV_8UC1: 0 outside, n for object n. Where SourceInfo::key_masks says so, most
  /// frames have none, and none of those that are there is empty of objects.
  cv::Mat mask;
};

/// A problem with the source that a person has to mend; what() is one line naming the file and what
/// to do.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class RgbdSource {
 public:
  virtual ~RgbdSource() = default;
  [[nodiscard]] virtual const SourceInfo& info() const = 0;
  /// The next frame; nullopt at the end of the clip. A frame that cannot be read is passed over
  /// with one warning line. Throws SourceError when no further frame can be had. Thread: one.
  virtual std::optional<RgbdFrame> read() = 0;
  /// Passes over the next frame without decoding it where possible; false at the end.
  virtual bool skip() = 0;
  /// Back to the first frame (epoch + 1). Throws SourceError on a live source.
  virtual void rewind() = 0;
};

/// The last part of a path, which is all that viewers need to know of it.
std::string fileName(const std::filesystem::path& path);

/// Opens what --source names: synthetic:NAME, DIR, COLOR,DEPTH or camera:N[,M]. `fps` > 0 overrides
/// the source's own rate. Throws SourceError.
std::unique_ptr<RgbdSource> openSource(const std::string& spec, double fps);

}  // namespace hapticast::server
