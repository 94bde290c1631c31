// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/object_roi.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/masks.hpp"

namespace hapticast::server {

namespace {

// Chosen: a crease between finger and object is some 5 mm deep and 10 mm wide.
constexpr double kValley_mm = 8.0;       // reach of the mean around a pixel
constexpr double kLeastValley_mm = 0.7;  // shallower: curvature of one body
constexpr double kMostValley_mm = 3.0;

// Returns the mean of the measured depths around each pixel (Gaussian weights), 0 without any.
cv::Mat meanDepth(const cv::Mat& depth, const cv::Mat& measured, double sigma_px) {
  cv::Mat sum;
  cv::Mat weight;
  cv::GaussianBlur(depth, sum, {}, sigma_px);
  cv::GaussianBlur(measured, weight, {}, sigma_px);
  cv::Mat out;
  cv::divide(sum, cv::max(weight, 1e-3), out);
  return out;
}

// Concave creases, by the difference of two means of depth (difference of Gaussians).
cv::Mat findValleys(const GraphRoi& view, const DepthNoise& noise, double px_per_mm) {
  cv::Mat measured;
  cv::Mat(view.depth > 0).convertTo(measured, CV_32F, 1.0 / 255.0);
  const double sigma_px = std::clamp(kValley_mm * px_per_mm, 2.0, 8.0);
  const cv::Mat deeper = meanDepth(view.depth, measured, std::max(1.0, 0.3 * sigma_px)) -
                         meanDepth(view.depth, measured, sigma_px);
  cv::Mat out(view.depth.size(), CV_32FC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const auto z = double(view.depth.at<float>(v, u));
      const double least_mm = kLeastValley_mm + 0.5 * noise.at(z);
      const double depth_mm = double(deeper.at<float>(v, u)) - least_mm;
      out.at<float>(v, u) =
          z > 0 ? static_cast<float>(std::clamp(depth_mm / kMostValley_mm, 0.0, 1.0)) : 0.0F;
    }
  }
  return out;
}

// Returns findOnPlanes() at every pixel of a size to which the box is shrunk.
cv::Mat samplePlanes(const cv::Mat& depth, const cv::Rect& box, const cv::Size& size,
                     const std::vector<Plane>& planes) {
  cv::Mat out = cv::Mat::zeros(size, CV_8UC1);
  const double step_u = 1.0 / (size.width / double(box.width));
  const double step_v = 1.0 / (size.height / double(box.height));
  for (int v = 0; v < size.height; ++v) {
    const int from_v = box.y + std::min(static_cast<int>(v * step_v), box.height - 1);
    for (int u = 0; u < size.width; ++u) {
      const int from_u = box.x + std::min(static_cast<int>(u * step_u), box.width - 1);
      const float z = depth.at<float>(from_v, from_u);
      if (z > 0.0F && isOnPlanes(planes, from_u, from_v, double(z))) out.at<uchar>(v, u) = 255;
    }
  }
  return out;
}

// Returns the part `box` of a picture, in a large picture reduced to the usual width.
cv::Mat scaleToUsualWidth(const cv::Mat& color, const cv::Rect& box) {
  const int factor = std::max(1, std::max(color.cols, color.rows) / kUsualWidth_px);
  cv::Mat out;
  cv::resize(color(box), out, {}, 1.0 / factor, 1.0 / factor, cv::INTER_AREA);
  return out;
}

}  // namespace

cv::Mat FrameContext::findHands(const cv::Rect& box, const cv::Size& size) const {
  cv::Mat out;
  if (hand.empty()) {
    cv::resize(skin.findSkin(scaleToUsualWidth(images.color, box)), out, size, 0, 0,
               cv::INTER_NEAREST);
    return out;
  }
  cv::resize(hand(box), out, size, 0, 0, cv::INTER_AREA);
  return (out > 127) & findDarkSkin(box, size);
}

cv::Mat FrameContext::findDarkSkin(const cv::Rect& box, const cv::Size& size) const {
  cv::Mat out;
  cv::resize(skin.findWithDark(scaleToUsualWidth(images.color, box)), out, size, 0, 0,
             cv::INTER_NEAREST);
  return out;
}

GraphRoi GraphRoi::makeAround(const FrameContext& scene, const cv::Rect& box, double most_px) {
  GraphRoi out;
  out.box = box;
  out.shrink = std::min(1.0, std::sqrt(most_px / std::max(1, box.area())));
  const cv::Size size(std::max(1, int(std::lround(box.width * out.shrink))),
                      std::max(1, int(std::lround(box.height * out.shrink))));
  cv::resize(scene.images.color(box), out.color, size, 0, 0, cv::INTER_AREA);
  cv::resize(scene.images.depth(box), out.depth, size, 0, 0, cv::INTER_NEAREST);
  out.plane = samplePlanes(scene.images.depth, box, size, scene.planes);
  out.skin = scene.findHands(box, size);
  out.color.convertTo(out.lab, CV_32F, 1.0 / 255.0);
  cv::cvtColor(out.lab, out.lab, cv::COLOR_BGR2Lab);
  return out;
}

GraphRoi GraphRoi::makeWithValleys(const FrameContext& scene, const cv::Rect& box, double most_px) {
  GraphRoi out = makeAround(scene, box, most_px);
  const double middle_mm = std::max(1.0, medianDepth(out.depth, out.depth > 0, 4));
  const double px_per_mm = out.shrink * pixelsPerMm(middle_mm, scene.images.color.size());
  out.valley = findValleys(out, scene.noise, px_per_mm);
  return out;
}

cv::Mat GraphRoi::shrinkImage(const cv::Mat& mask) const {
  cv::Mat out;
  cv::resize(mask(box), out, size(), 0, 0, cv::INTER_AREA);
  return out > 127;
}

cv::Mat GraphRoi::placeInPicture(const cv::Mat& mask, const cv::Size& picture) const {
  cv::Mat large;
  cv::resize(mask, large, box.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat out = cv::Mat::zeros(picture, CV_8UC1);
  cv::Mat(large > 127).copyTo(out(box));
  return out;
}

cv::Point GraphRoi::toRoi(const cv::Point& at) const {
  const cv::Size small = size();
  return {std::clamp(int((at.x - box.x + 0.5) * small.width / box.width), 0, small.width - 1),
          std::clamp(int((at.y - box.y + 0.5) * small.height / box.height), 0, small.height - 1)};
}

namespace {

constexpr double kLargestPatch_px = 90e3;  // chosen for time: 300 x 300
constexpr double kMostPast = 0.5;          // chosen, of the object
// Chosen, nats: colours of skin with less evidence for the object are a hand's.
constexpr float kRatherHand = -1.0F;

// Returns the bounding box of `from` after the similarity.
cv::Rect moveBox(const cv::Rect& from, const cv::Matx23d& similarity, const cv::Size& picture) {
  std::vector<cv::Point2f> corners;
  for (const cv::Point& at :
       {from.tl(), from.br(), cv::Point(from.x, from.br().y), cv::Point(from.br().x, from.y)}) {
    const cv::Vec2d to = similarity * cv::Vec3d(at.x, at.y, 1.0);
    if (!(cv::norm(to) < 1e5)) return {};
    corners.emplace_back(static_cast<float>(to[0]), static_cast<float>(to[1]));
  }
  return cv::boundingRect(corners) & cv::Rect({0, 0}, picture);
}

int computeFactor(const cv::Rect& object, const cv::Size& picture) {
  const int largest = std::max(1, std::max(picture.width, picture.height) / kUsualWidth_px);
  for (int factor = 1; factor < largest; ++factor) {
    const int margin = 2 * (kBand_px + kRing_px);
    const double width = double(object.width) / factor + margin;
    const double height = double(object.height) / factor + margin;
    if (width * height <= kLargestPatch_px) return factor;
  }
  return largest;
}

// Clips the box to multiples of the factor, at the side that is not the picture's border.
cv::Rect wholePixels(cv::Rect box, int factor) {
  const int extra_u = box.width % factor;
  const int extra_v = box.height % factor;
  if (box.x > 0) box.x += extra_u;
  if (box.y > 0) box.y += extra_v;
  box.width -= extra_u;
  box.height -= extra_v;
  return box;
}

void computeDistance(ObjectRoi& patch) {
  // One transform serves both sides: the distance to the outermost pixels inside.
  cv::Mat inner;
  cv::erode(patch.inside, inner, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  cv::distanceTransform((patch.inside == 0) | inner, patch.distance, cv::DIST_L2, 3);
  for (int v = 0; v < patch.inside.rows; ++v) {
    const auto* in = patch.inside.ptr<unsigned char>(v);
    auto* d = patch.distance.ptr<float>(v);
    for (int u = 0; u < patch.inside.cols; ++u) d[u] = in[u] != 0 ? d[u] + 1.0F : -d[u];
  }
}

void markHidden(ObjectRoi& patch, const ObjectLimits& limits) {
  const cv::Mat square = cv::Mat::ones(3, 3, CV_8UC1);
  if (limits.nearest_mm > 0 || limits.hand != nullptr) {
    patch.nearer = (patch.depth > 0) & (patch.depth < limits.nearest_mm);
    cv::morphologyEx(patch.nearer, patch.nearer, cv::MORPH_OPEN, square);
    if (limits.hand != nullptr) patch.nearer |= findHand(patch.color, limits);
    patch.hidden = patch.nearer & patch.inside;
    if (cv::countNonZero(patch.hidden) > 0) patch.inside.setTo(0, patch.hidden);
  }
  if (limits.farthest_mm > 0) {
    patch.farther = patch.depth > limits.farthest_mm;
    cv::morphologyEx(patch.farther, patch.farther, cv::MORPH_OPEN, square);
    const int past = cv::countNonZero(patch.farther & patch.inside);
    // The whole object cannot be uncovered at once: then its depth jumped.
    if (past > kMostPast * cv::countNonZero(patch.inside)) patch.farther.setTo(0);
    patch.inside.setTo(0, patch.farther);
  }
}

}  // namespace

cv::Mat findHand(const cv::Mat& color, const ObjectLimits& limits) {
  if (limits.hand == nullptr) return cv::Mat::zeros(color.size(), CV_8UC1);
  cv::Mat out = limits.hand->findSkin(color);
  if (limits.colors.empty()) return out;
  for (int v = 0; v < out.rows; ++v) {
    const auto* from = color.ptr<cv::Vec3b>(v);
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (limits.colors[ColorHistogram::binIndex(from[u])] > kRatherHand) to[u] = 0;
    }
  }
  return out;
}

cv::Matx33d ObjectRoi::toPicture() const {
  const double f = factor;
  return {f, 0, pictureU(0), 0, f, pictureV(0), 0, 0, 1};
}

ObjectRoi makePatch(const FrameImages& images, const cv::Mat& mask, const cv::Matx23d& similarity,
                    const ObjectLimits& limits) {
  ObjectRoi out;
  const cv::Rect from = findBoxAround(mask, 1);
  if (from.empty()) return out;
  const cv::Rect to = moveBox(from, similarity, mask.size());
  if (to.empty()) return out;
  out.factor = computeFactor(to, mask.size());
  out.box = wholePixels(growRect(to, out.factor * (kBand_px + kRing_px), mask.size()), out.factor);
  if (out.box.width < 8 * out.factor || out.box.height < 8 * out.factor) return {};
  const cv::Size size(out.box.width / out.factor, out.box.height / out.factor);
  out.gray = images.gray(out.box);
  out.color = images.color(out.box);
  out.depth = images.depth(out.box);
  if (out.factor > 1) {
    cv::resize(out.color, out.color, size, 0, 0, cv::INTER_AREA);
    cv::resize(out.depth, out.depth, size, 0, 0, cv::INTER_NEAREST);
  }
  const cv::Matx33d corner{1, 0, double(from.x), 0, 1, double(from.y), 0, 0, 1};
  out.inside = warpPatch(mask(from), corner, out, similarity) > 127;
  markHidden(out, limits);
  computeDistance(out);
  return out;
}

ObjectRoi makePatch(const FrameImages& images, const cv::Mat& mask) {
  return makePatch(images, mask, {1, 0, 0, 0, 1, 0}, ObjectLimits{});
}

cv::Mat warpPatch(const cv::Mat& image, const cv::Matx33d& from, const ObjectRoi& to,
                  const cv::Matx23d& similarity) {
  const cv::Matx33d local = to.toPicture().inv() * homogeneous(similarity) * from;
  const cv::Size size(to.box.width / to.factor, to.box.height / to.factor);
  cv::Mat out;
  cv::warpAffine(image, out, local.get_minor<2, 3>(0, 0), size, cv::INTER_LINEAR,
                 cv::BORDER_CONSTANT, cv::Scalar(0));
  return out;
}

cv::Mat scaleToFullSize(const cv::Mat& mask, const ObjectRoi& patch) {
  if (patch.factor == 1) return mask;
  cv::Mat out;
  cv::resize(mask, out, patch.box.size(), 0, 0, cv::INTER_LINEAR);
  return out > 127;
}

cv::Mat scaleToPatchSize(const cv::Mat& mask, const ObjectRoi& patch) {
  if (patch.factor == 1) return mask;
  cv::Mat out;
  cv::resize(mask, out, patch.inside.size(), 0, 0, cv::INTER_AREA);
  return out > 127;
}

cv::Mat wholePicture(const cv::Mat& mask, const ObjectRoi& patch, const FrameImages& images) {
  cv::Mat out = cv::Mat::zeros(images.gray.size(), CV_8UC1);
  mask.copyTo(out(patch.box));
  return out;
}

cv::Mat findBandOnPlanes(const ObjectRoi& patch, const std::vector<Plane>& planes) {
  cv::Mat out = cv::Mat::zeros(patch.depth.size(), CV_8UC1);
  if (planes.empty()) return out;
  for (int v = 0; v < out.rows; ++v) {
    const auto* depth = patch.depth.ptr<float>(v);
    const auto* d = patch.distance.ptr<float>(v);
    auto* to = out.ptr<unsigned char>(v);
    for (int u = 0; u < out.cols; ++u) {
      if (depth[u] <= 0.0F || d[u] > kBand_px || d[u] <= -kBand_px) continue;
      if (isOnPlanes(planes, patch.pictureU(u), patch.pictureV(v), double(depth[u]))) to[u] = 255;
    }
  }
  return out;
}

double DepthSpan::nearest_mm(const DepthNoise& noise) const {
  if (middle_mm <= 0) return 0.0;
  return near_mm - 0.6 * (far_mm - near_mm) - 25.0 - 6 * noise.at(near_mm);
}

double DepthSpan::farthest_mm(const DepthNoise& noise) const {
  if (middle_mm <= 0) return 0.0;
  return far_mm + 0.8 * (far_mm - near_mm) + 30.0 + 6 * noise.at(far_mm);
}

std::optional<DepthSpan> depthSpan(const ObjectRoi& patch, const cv::Mat& inside) {
  std::vector<float> values;
  for (int v = 0; v < inside.rows; v += 2) {
    const auto* depth = patch.depth.ptr<float>(v);
    const auto* in = inside.ptr<unsigned char>(v);
    for (int u = 0; u < inside.cols; u += 2) {
      if (in[u] != 0 && depth[u] > 0) values.push_back(depth[u]);
    }
  }
  if (values.size() < 10) return std::nullopt;
  const auto quantile = [&](std::size_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * percent / 100);
    std::nth_element(values.begin(), at, values.end());
    return static_cast<double>(*at);
  };
  return DepthSpan{quantile(10), quantile(50), quantile(90)};
}

}  // namespace hapticast::server
