// SPDX-License-Identifier: MIT
// Masks from the user's program (--mask-from). A request is a line of JSON, the picture and its
// depth (encodeMaskRequest()). The answer is a line "WIDTH HEIGHT" and a byte for each pixel: 0, or
// n for object n. "0 0" means: no mask for this frame. The masks are key masks: a frame with one
// shows exactly that, and vision's own tracker carries it to the frames without one. Thread: that
// of ChildSource.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/source/child/child_source.hpp"
#include "server/source/child/mask_folder.hpp"

namespace hapticast::server {

/// A point of the author for the program.
struct MaskPoint {
  Vec2 at_px = Vec2::Zero();  ///< in the frame, px
  double time_s = 0.0;        ///< time in the clip, s
  int object = 0;             ///< number of its object, from 1; 0: it lies on no object
};

/// Returns the request for `frame`: one line of JSON with the members frame, time_s, width, height
/// and points, then width x height pixels of 3 bytes (RGB), then as many little-endian float32 (mm,
/// 0: not measured). Each point has object, u, v and time_s. They are all points up to the time of
/// the frame. Requires depth of the size of the colour. Thread: any.
[[nodiscard]] std::vector<std::uint8_t> encodeMaskRequest(const RgbdFrame& frame,
                                                          const std::vector<MaskPoint>& points);

/// Returns the size in the header `line`, 0x0 for "0 0"; nullopt if it is no header, or if a side
/// is above 4096 px. Thread: any.
[[nodiscard]] std::optional<cv::Size> parseMaskHeader(const std::string& line);

/// The task of a child that segments.
class MaskTask final : public ChildTask {
 public:
  /// `folder`: receives the masks; may be null. `live`: frames never come again.
  MaskTask(std::string command, std::vector<MaskPoint> points, std::unique_ptr<MaskFolder> folder,
           bool live = false)
      : command_(std::move(command)),
        points_(std::move(points)),
        folder_(std::move(folder)),
        live_(live) {}

  [[nodiscard]] const char* flag() const override { return "--mask-from"; }
  [[nodiscard]] const std::string& command() const override { return command_; }
  [[nodiscard]] bool isRequired() const override { return false; }
  bool recall(RgbdFrame& frame) override;
  [[nodiscard]] std::vector<std::uint8_t> ask(const RgbdFrame& frame) override {
    return encodeMaskRequest(frame, points_);
  }
  [[nodiscard]] std::optional<std::size_t> measure(const std::string& header) const override;
  std::string apply(RgbdFrame& frame, const ChildAnswer& answer) override;
  void describe(SourceInfo& info) const override { info.key_masks = true; }

 private:
  void remember(std::uint64_t index, const cv::Mat& mask);

  std::string command_;
  std::vector<MaskPoint> points_;
  std::unique_ptr<MaskFolder> folder_;
  bool live_;
  std::map<std::uint64_t, std::vector<std::uint8_t>> kept_;  // PNG by frame; empty: no mask
  std::size_t kept_bytes_ = 0;
};

}  // namespace hapticast::server
