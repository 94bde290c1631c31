// SPDX-License-Identifier: MIT
#include "server/vision/segment/small_view.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr double kUsualFocal = 0.94;  // of the width: the field of view of most cameras

cv::Mat labOf(const cv::Mat& color) {
  cv::Mat out;
  color.convertTo(out, CV_32F, 1.0 / 255.0);
  cv::cvtColor(out, out, cv::COLOR_BGR2Lab);
  return out;
}

// The colour cast (a, b per L) of what is bright and nearly grey; chosen: the brightest fortieth.
cv::Vec2f castOf(const cv::Mat& lab) {
  std::vector<cv::Vec3f> grey;
  grey.reserve(lab.total());
  for (int v = 0; v < lab.rows; ++v) {
    for (int u = 0; u < lab.cols; ++u) {
      const auto& at = lab.at<cv::Vec3f>(v, u);
      if (std::hypot(at[1], at[2]) < 25.0F && at[0] < 99.0F) grey.push_back(at);
    }
  }
  if (grey.size() < 40) return {0.0F, 0.0F};
  const auto brightest = grey.end() - static_cast<std::ptrdiff_t>(grey.size() / 40);
  std::nth_element(grey.begin(), brightest, grey.end(),
                   [](const cv::Vec3f& a, const cv::Vec3f& b) { return a[0] < b[0]; });
  cv::Vec2f sum(0.0F, 0.0F);
  for (auto it = brightest; it != grey.end(); ++it)
    sum += cv::Vec2f((*it)[1], (*it)[2]) / std::max((*it)[0], 1.0F);
  return sum / static_cast<float>(grey.end() - brightest);
}

// Chosen from people of light and dark skin in warm and cold light: red to yellow, not too pale and
// not too strong.
bool isSkin(const cv::Vec3f& lab, const cv::Vec2f& cast) {
  const float a = lab[1] - cast[0] * lab[0];
  const float b = lab[2] - cast[1] * lab[0];
  const float chroma = std::hypot(a, b);
  const float hue = std::atan2(b, a) * 57.29578F;
  return lab[0] > 18.0F && a > 7.0F && a < 32.0F && hue > 8.0F && hue < 68.0F && chroma > 11.0F &&
         chroma < 46.0F;
}

}  // namespace

double pixelsPerMm(double depth_mm, const cv::Size& picture) {
  return kUsualFocal * picture.width / std::max(depth_mm, 1.0);
}

cv::Mat skinOf(const FrameImages& images) {
  const int factor = std::max(1, images.color.cols / 320);
  cv::Mat small;
  cv::resize(images.color, small, {}, 1.0 / factor, 1.0 / factor, cv::INTER_AREA);
  const cv::Mat lab = labOf(small);
  const cv::Vec2f cast = castOf(lab);
  cv::Mat skin(lab.size(), CV_8UC1);
  for (int v = 0; v < skin.rows; ++v) {
    for (int u = 0; u < skin.cols; ++u)
      skin.at<unsigned char>(v, u) = isSkin(lab.at<cv::Vec3f>(v, u), cast) ? 255 : 0;
  }
  cv::medianBlur(skin, skin, 3);
  cv::morphologyEx(skin, skin, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  cv::resize(skin, skin, images.color.size(), 0, 0, cv::INTER_NEAREST);
  return skin;
}

SmallView SmallView::of(const SceneView& scene, const cv::Rect& box, double most_px) {
  SmallView out;
  out.box = box;
  out.shrink = std::min(1.0, std::sqrt(most_px / std::max(1, box.area())));
  const cv::Size size(std::max(1, int(std::lround(box.width * out.shrink))),
                      std::max(1, int(std::lround(box.height * out.shrink))));
  cv::resize(scene.images.color(box), out.color, size, 0, 0, cv::INTER_AREA);
  cv::resize(scene.images.depth(box), out.depth, size, 0, 0, cv::INTER_NEAREST);
  const cv::Mat plane = onPlanes(scene.images.depth, box, scene.planes);
  cv::resize(plane, out.plane, size, 0, 0, cv::INTER_NEAREST);
  if (!scene.skin.empty())
    cv::resize(scene.skin(box), out.skin, size, 0, 0, cv::INTER_NEAREST);
  else
    out.skin = cv::Mat::zeros(size, CV_8UC1);
  out.lab = labOf(out.color);
  return out;
}

cv::Mat SmallView::shrunk(const cv::Mat& mask) const {
  cv::Mat out;
  cv::resize(mask(box), out, size(), 0, 0, cv::INTER_AREA);
  return out > 127;
}

cv::Mat SmallView::inPicture(const cv::Mat& mask, const cv::Size& picture) const {
  cv::Mat large;
  cv::resize(mask, large, box.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out = cv::Mat::zeros(picture, CV_8UC1);
  cv::Mat(large > 127).copyTo(out(box));
  return out;
}

cv::Point SmallView::placeOf(const cv::Point& at) const {
  const cv::Size small = size();
  return {std::clamp(int((at.x - box.x + 0.5) * small.width / box.width), 0, small.width - 1),
          std::clamp(int((at.y - box.y + 0.5) * small.height / box.height), 0, small.height - 1)};
}

}  // namespace hapticast::server
