// SPDX-License-Identifier: MIT
// Pictures to look at: every so manyth frame of a clip with the outline of its mask.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace hapticast::evaluate {

class ContactSheet {
 public:
  /// Takes every `every`th of the frames it is shown.
  explicit ContactSheet(std::size_t every = 8) : every_(every) {}

  /// `mask` in red, `truth` (may be empty) in green; no mask: the picture is crossed out. `number`
  /// stands in its corner, else how many were shown before.
  void show(const cv::Mat& color, const cv::Mat& mask, const cv::Mat& truth = {},
            std::optional<std::size_t> number = std::nullopt);
  /// Four in a row. Throws std::runtime_error where it cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  std::size_t every_;
  std::size_t shown_ = 0;
  std::vector<cv::Mat> pictures_;
};

}  // namespace hapticast::evaluate
