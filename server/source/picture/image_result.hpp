// SPDX-License-Identifier: MIT
// The result of reading an image. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace hapticast::server {

/// An image, or a phrase with its problem ("is cut off").
struct ImageResult {
  cv::Mat image;
  std::string problem;

  [[nodiscard]] bool ok() const { return problem.empty(); }
};

}  // namespace hapticast::server
