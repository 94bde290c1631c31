// SPDX-License-Identifier: MIT
// The depth images of a folder whose colour is a video. Thread: any; at most one at a time for each
// folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "server/source/picture/depth_sequence.hpp"

namespace hapticast::server {

/// The depth images of a folder. Image number n (000012.png: 12) belongs to frame n of the colour.
class DepthFolder final : public DepthSequence {
 public:
  /// Finds the images in `folder`. `color_frames`: number of colour frames, if it is known. If
  /// numbers run from 1 to `color_frames`, image 1 belongs to the first frame. If a name has no
  /// number, images belong to frames in the order of their names. `confidence`: folder with images
  /// of the same names and sizes, 8-bit grey, whose 0 means that the depth is not measured; empty:
  /// there is none. Throws SourceError.
  DepthFolder(const std::filesystem::path& folder, std::optional<std::uint64_t> color_frames,
              std::filesystem::path confidence);

  /// Returns the largest number of an image + 1: missing numbers count.
  [[nodiscard]] std::uint64_t count() const override { return files_.rbegin()->first + 1; }
  [[nodiscard]] std::optional<ImageResult> next() override;
  bool skip() override;
  void rewind() override { next_ = 0; }
  [[nodiscard]] std::string pictureName(std::uint64_t index) const override;

 private:
  /// Sets the depth to 0 where the confidence is 0. Returns the problem of the confidence image, or
  /// "". A depth image without one is left as it is.
  [[nodiscard]] std::string applyConfidence(const std::filesystem::path& file,
                                            cv::Mat& depth) const;

  std::filesystem::path folder_;
  std::filesystem::path confidence_;
  std::map<std::uint64_t, std::filesystem::path> files_;  // by frame, at least one
  std::uint64_t next_ = 0;
};

}  // namespace hapticast::server
