// SPDX-License-Identifier: MIT
#include "server/vision/motion/rigid_roi.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

namespace {

constexpr double kDepthReach_mm = 80.0;  // chosen: more than a body moves in a frame

}  // namespace

cv::Mat shrinkImage(const cv::Mat& image, int factor) {
  if (factor == 1) return image;
  cv::Mat out;
  cv::resize(image, out, {image.cols / factor, image.rows / factor}, 0, 0, cv::INTER_AREA);
  return out;
}

cv::Mat smoothDepth(const cv::Mat& depth, const cv::Mat& known, int factor) {
  cv::Mat weight;
  known.convertTo(weight, CV_32F, 1.0 / 255.0);
  cv::Mat weighted = shrinkImage(depth.mul(weight), factor);
  weight = shrinkImage(weight, factor);
  cv::GaussianBlur(weighted, weighted, {7, 7}, 1.5);
  cv::GaussianBlur(weight, weight, {7, 7}, 1.5);
  cv::Mat out;
  cv::divide(weighted, cv::max(weight, 1e-6), out);
  out.setTo(0.0, weight < 0.4);
  return out;
}

cv::Mat smoothGray(const cv::Mat& gray, int factor) {
  cv::Mat out;
  shrinkImage(gray, factor).convertTo(out, CV_32F);
  cv::GaussianBlur(out, out, {5, 5}, 1.0);
  return out;
}

RigidRoi cropRoi(const FrameImages& images, const cv::Rect& area, int factor,
                 const DepthRange& depths) {
  RigidRoi out;
  out.origin = area.tl();
  out.factor = factor;
  const cv::Rect whole(area.x, area.y, area.width / factor * factor, area.height / factor * factor);
  if (whole.width < 3 * factor || whole.height < 3 * factor) return out;
  const cv::Mat gray = smoothGray(images.gray(whole), factor);
  const cv::Mat raw = images.depth(whole);
  const cv::Mat known =
      (raw > depths.near_mm - kDepthReach_mm) & (raw < depths.far_mm + kDepthReach_mm) & (raw > 0);
  const cv::Mat depth = smoothDepth(raw, known, factor);
  out.columns = gray.cols;
  out.rows = gray.rows;
  out.texels.resize(gray.total());
  for (int v = 0; v < gray.rows; ++v) {
    const int above = std::max(0, v - 1);
    const int below = std::min(gray.rows - 1, v + 1);
    for (int u = 0; u < gray.cols; ++u) {
      const int left = std::max(0, u - 1);
      const int right = std::min(gray.cols - 1, u + 1);
      Texel& texel = out.texels[static_cast<std::size_t>(v * gray.cols + u)];
      texel.gray = gray.at<float>(v, u);
      texel.gray_u = 0.5F * (gray.at<float>(v, right) - gray.at<float>(v, left));
      texel.gray_v = 0.5F * (gray.at<float>(below, u) - gray.at<float>(above, u));
      const float here = depth.at<float>(v, u);
      const float l = depth.at<float>(v, left), r = depth.at<float>(v, right);
      const float a = depth.at<float>(above, u), b = depth.at<float>(below, u);
      const bool whole_cross = here > 0 && l > 0 && r > 0 && a > 0 && b > 0;
      texel.depth = whole_cross ? here : 0.0F;
      texel.depth_u = whole_cross ? 0.5F * (r - l) : 0.0F;
      texel.depth_v = whole_cross ? 0.5F * (b - a) : 0.0F;
    }
  }
  return out;
}

bool RigidRoi::sample(const Eigen::Vector2d& at, Texel& out) const {
  const double u = std::floor(at.x());
  const double v = std::floor(at.y());
  if (!(u >= 0 && v >= 0 && u + 1 < columns && v + 1 < rows)) return false;
  const auto a = static_cast<float>(at.x() - u);
  const auto b = static_cast<float>(at.y() - v);
  const Texel* row = &texels[static_cast<std::size_t>(v) * static_cast<std::size_t>(columns) +
                             static_cast<std::size_t>(u)];
  const Texel& p = row[0];
  const Texel& q = row[1];
  const Texel& r = row[columns];
  const Texel& s = row[columns + 1];
  const float wp = (1 - a) * (1 - b), wq = a * (1 - b), wr = (1 - a) * b, ws = a * b;
  const auto mix = [&](float Texel::*field) {
    return wp * p.*field + wq * q.*field + wr * r.*field + ws * s.*field;
  };
  out = {mix(&Texel::gray), mix(&Texel::gray_u), mix(&Texel::gray_v), 0, 0, 0};
  if (p.depth > 0 && q.depth > 0 && r.depth > 0 && s.depth > 0) {
    out.depth = mix(&Texel::depth);
    out.depth_u = mix(&Texel::depth_u);
    out.depth_v = mix(&Texel::depth_v);
  }
  return true;
}

}  // namespace hapticast::server
