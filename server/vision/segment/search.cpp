// SPDX-License-Identifier: MIT
#include "server/vision/segment/search.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace hapticast::server {

cv::Mat likeliestPlace(const FrameImages& images, const ColorHistogram& colors, double depth_mm,
                       double area_px) {
  const std::vector<float> evidence =
      colorEvidence(colors, colors, ColorHistogram::of(images.color));
  cv::Mat likely(images.color.size(), CV_32FC1);
  for (int v = 0; v < likely.rows; ++v) {
    for (int u = 0; u < likely.cols; ++u) {
      const auto z = double(images.depth.at<float>(v, u));
      const bool far_off = z > 0 && (z < 0.6 * depth_mm || z > 1.6 * depth_mm);
      likely.at<float>(v, u) =
          far_off ? -2.5F : evidence[ColorHistogram::binOf(images.color.at<cv::Vec3b>(v, u))];
    }
  }
  cv::GaussianBlur(likely, likely, {}, 3.0);
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centroids;
  const int count =
      cv::connectedComponentsWithStats(likely > 0.5, labels, stats, centroids, 8, CV_32S);
  int best = 0;
  for (int i = 1; i < count; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    if (area < 0.25 * area_px || area > 3 * area_px) continue;
    if (best == 0 || area > stats.at<int>(best, cv::CC_STAT_AREA)) best = i;
  }
  return best == 0 ? cv::Mat() : cv::Mat(labels == best);
}

}  // namespace hapticast::server
