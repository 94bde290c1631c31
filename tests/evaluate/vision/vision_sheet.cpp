// SPDX-License-Identifier: MIT
#include "tests/evaluate/vision/vision_sheet.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace hapticast::evaluate {

namespace {

constexpr int kColumns = 4;
constexpr int kWidth_px = 480;

void outline(cv::Mat& picture, const cv::Mat& mask, const cv::Scalar& color) {
  if (mask.empty()) return;
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(picture, contours, -1, color, 1);
}

}  // namespace

void ContactSheet::show(const cv::Mat& color, const cv::Mat& mask, const cv::Mat& truth,
                        std::optional<std::size_t> number) {
  if (shown_++ % every_ != 0) return;
  cv::Mat picture = color.clone();
  outline(picture, truth, {0, 255, 0});
  outline(picture, mask, {0, 0, 255});
  if (mask.empty()) cv::line(picture, {0, 0}, {picture.cols, picture.rows}, {0, 0, 255}, 3);
  const int height = picture.rows * kWidth_px / picture.cols;
  cv::resize(picture, picture, {kWidth_px, height}, 0, 0, cv::INTER_AREA);
  cv::putText(picture, std::to_string(number.value_or(shown_ - 1)), {6, 18},
              cv::FONT_HERSHEY_SIMPLEX, 0.5, {255, 255, 255});
  pictures_.push_back(picture);
}

void ContactSheet::write(const std::filesystem::path& path) const {
  if (pictures_.empty()) return;
  const cv::Size one = pictures_[0].size();
  const int count = static_cast<int>(pictures_.size());
  const int rows = (count + kColumns - 1) / kColumns;
  cv::Mat sheet = cv::Mat::zeros(rows * one.height, kColumns * one.width, CV_8UC3);
  for (int i = 0; i < count; ++i) {
    const cv::Rect place((i % kColumns) * one.width, (i / kColumns) * one.height, one.width,
                         one.height);
    pictures_[static_cast<std::size_t>(i)].copyTo(sheet(place));
  }
  if (!cv::imwrite(path.string(), sheet))
    throw std::runtime_error("--out: cannot write " + path.string());
}

}  // namespace hapticast::evaluate
