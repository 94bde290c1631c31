// SPDX-License-Identifier: MIT
#include "server/source/video/first_pictures.hpp"

#include "server/source/picture/depth_code.hpp"
#include "server/source/scale/depth_scale.hpp"

namespace hapticast::server {

FirstPictures describeFirst(const cv::Mat& color, const cv::Mat& raw, DepthCode code,
                            const std::string& depth_name) {
  if (raw.depth() != CV_8U && code != DepthCode::kGrey)
    throw SourceError(depth_name + ": has depth in mm, so leave --depth-near and --depth-code out");
  const cv::Mat depth = decodeDepth(raw, code);
  if (!isSameAspect(depth.size(), color.size())) {
    throw SourceError(depth_name + ": is " + sizeText(depth.cols, depth.rows) +
                      ", but the colour video is " + sizeText(color.cols, color.rows) +
                      aspectRemedy(depth.size(), color.size()));
  }
  if (isColorCoded(depth))
    throw SourceError(depth_name + ": shows depth as colours; make it grey (near is white)");
  // Hue is a code of mm in 8 bits, so the decoded picture decides.
  return {color.size(), depth.size(),
          depth.depth() != CV_8U ? DepthKind::kMetric : DepthKind::kHeight};
}

double plausibleRate(double stated_fps) {
  return stated_fps >= 1.0 && stated_fps <= 240.0 ? stated_fps : 25.0;
}

}  // namespace hapticast::server
