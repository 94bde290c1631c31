// SPDX-License-Identifier: MIT
// Depth from the user's program (--depth-from). Each picture goes to its stdin as binary PPM (P6).
// The answer is a line "WIDTH HEIGHT KIND", and the depth as little-endian float32, row by row from
// the top. The kind metric_mm is mm along the optical axis. relative (far is large) and inverse
// (near is large) have an unknown scale and shift; the nearest and the farthest 2 % of the first
// picture then become the depths of a range. Thread: that of ChildSource.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/source/child/child_source.hpp"
#include "server/source/child/depth_cache.hpp"

namespace hapticast::server {

/// What the header of an answer states.
struct DepthHeader {
  int width_px = 0;
  int height_px = 0;
  EstimatedDepth kind = EstimatedDepth::kNone;
  bool operator==(const DepthHeader&) const = default;
};

/// Returns the header in `line`; nullopt if it is none, or if a side is above 4096 px. Thread: any.
[[nodiscard]] std::optional<DepthHeader> parseDepthHeader(const std::string& line);

/// Writes the pixels of `color` (CV_8UC3, BGR) as RGB to 3 x width x height bytes. Thread: any.
void writeRgb(const cv::Mat& color, std::uint8_t* to);

/// Returns `color` (CV_8UC3, BGR) as binary PPM. Thread: any.
[[nodiscard]] std::vector<std::uint8_t> encodePpm(const cv::Mat& color);

/// Map from the values of a program to mm. Thread: any.
class RelativeDepthMap {
 public:
  /// Maps the 2nd and the 98th percentile of `values` (CV_32FC1) to the ends of `range`.
  RelativeDepthMap(const cv::Mat& values, EstimatedDepth kind, const DepthRange& range);
  /// Returns the depths of `values`, mm, CV_32FC1. A value that is not finite becomes 0. Depths
  /// beyond ten times the range end there.
  [[nodiscard]] cv::Mat convert(const cv::Mat& values) const;

 private:
  bool inverse_;
  DepthRange range_;
  double scale_ = 0.0;
  double shift_ = 0.0;
};

/// The task of a child that estimates depth.
class DepthTask final : public ChildTask {
 public:
  /// `range`: depths of relative kinds. `cache` may be null.
  DepthTask(std::string command, DepthRange range, std::unique_ptr<DepthCache> cache)
      : command_(std::move(command)), range_(range), cache_(std::move(cache)) {}

  [[nodiscard]] const char* flag() const override { return "--depth-from"; }
  [[nodiscard]] const std::string& command() const override { return command_; }
  [[nodiscard]] bool isRequired() const override { return true; }
  bool recall(RgbdFrame& frame) override;
  [[nodiscard]] std::vector<std::uint8_t> ask(const RgbdFrame& frame) override {
    return encodePpm(frame.color);
  }
  [[nodiscard]] std::optional<std::size_t> measure(const std::string& header) const override;
  std::string apply(RgbdFrame& frame, const ChildAnswer& answer) override;
  [[nodiscard]] const char* advise() const override {
    return cache_ != nullptr ? ""
                             : "the clip plays again, so the program estimates its depth again; "
                               "--depth-cache FOLDER keeps it";
  }
  void describe(SourceInfo& info) const override;

 private:
  std::string setDepth(RgbdFrame& frame, const ChildAnswer& answer);

  std::string command_;
  DepthRange range_;
  std::unique_ptr<DepthCache> cache_;
  std::optional<EstimatedDepth> kind_;  // of all answers
  std::optional<RelativeDepthMap> map_;
};

}  // namespace hapticast::server
