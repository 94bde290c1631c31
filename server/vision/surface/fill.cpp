// SPDX-License-Identifier: MIT
#include "server/vision/surface/fill.hpp"

#include <opencv2/imgproc.hpp>
#include <vector>

namespace hapticast::server {

namespace {

constexpr int kSweeps = 60;  // chosen: push-pull leaves roughness only a few pixels wide

cv::Mat pushPull(const cv::Mat& weighted, const cv::Mat& weight) {
  cv::Mat mean;
  cv::divide(weighted, cv::max(weight, 1e-6), mean);
  if (weighted.cols <= 2 && weighted.rows <= 2) {
    const double total = cv::sum(weight)[0];
    mean.setTo(total > 0 ? cv::sum(weighted)[0] / total : 0.0, weight <= 1e-6);
    return mean;
  }
  cv::Mat half_weighted;
  cv::Mat half_weight;
  const cv::Size half((weighted.cols + 1) / 2, (weighted.rows + 1) / 2);
  cv::resize(weighted, half_weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, half_weight, half, 0, 0, cv::INTER_AREA);
  cv::Mat coarse;
  cv::resize(pushPull(half_weighted, half_weight), coarse, weighted.size(), 0, 0, cv::INTER_LINEAR);
  coarse.copyTo(mean, weight <= 1e-6);
  return mean;
}

cv::Mat swept(const cv::Mat& from, const cv::Mat& inside, const std::vector<cv::Point>& holes) {
  cv::Mat values = from.clone();
  const cv::Rect whole({0, 0}, values.size());
  const cv::Point steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  for (int round = 0; round < kSweeps; ++round) {
    for (const cv::Point& at : holes) {
      float sum = 0;
      int count = 0;
      for (const cv::Point& step : steps) {
        if (!whole.contains(at + step) || inside.at<unsigned char>(at + step) == 0) continue;
        sum += values.at<float>(at + step);
        ++count;
      }
      if (count > 0) values.at<float>(at) = sum / static_cast<float>(count);
    }
  }
  return values;
}

}  // namespace

cv::Mat filledAtHalfSize(const cv::Mat& values, const cv::Mat& known) {
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat weighted = values.mul(weight);
  const cv::Size half((values.cols + 1) / 2, (values.rows + 1) / 2);
  cv::resize(weighted, weighted, half, 0, 0, cv::INTER_AREA);
  cv::resize(weight, weight, half, 0, 0, cv::INTER_AREA);
  return pushPull(weighted, weight);
}

cv::Mat filled(const cv::Mat& values, const cv::Mat& known, const cv::Mat& wanted) {
  std::vector<cv::Point> holes;
  cv::findNonZero(wanted & (known == 0), holes);
  if (holes.empty() || cv::countNonZero(known) == 0) return values.clone();
  cv::Mat out;
  cv::resize(filledAtHalfSize(values, known), out, values.size(), 0, 0, cv::INTER_LINEAR);
  values.copyTo(out, known);
  return swept(out, wanted | known, holes);
}

}  // namespace hapticast::server
