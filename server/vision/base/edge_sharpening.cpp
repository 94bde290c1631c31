// SPDX-License-Identifier: MIT
#include "server/vision/base/edge_sharpening.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

namespace hapticast::server {

namespace {

constexpr double kFocalWidths = 0.94;  // focal length of a usual camera, in widths of the picture
// Chosen: a ramp is steeper than tan 50 degrees, and than twice the slope of what is around it (a
// table at an angle).
constexpr float kSteep = 1.2F;
constexpr float kTimesSurface = 2.0F;
constexpr int kAround_px = 16;     // chosen: wider than a ramp of 30 px on either side
constexpr int kCoarse = 4;         // the slope around is measured at this reduction
constexpr float kSteepest = 2.0F;  // chosen: mean slope of a surface that is continued
constexpr int kReach_px = 20;      // chosen: longest way from a pixel to either end of its ramp
constexpr int kSample_px = 6;      // chosen: pixels behind an end whose colours are its mean
constexpr int kInside_px = 5;      // chosen: distance over which the slope of a surface is measured
constexpr float kMiddle = 0.1F;    // chosen: weight of the ramp's middle, where colours are alike
constexpr float kColorNoise = 150.0F;  // chosen, squared levels: noise of a camera
constexpr int kVote_px = 9;            // chosen: size of the neighbourhood that decides together

/// One end of a ramp, seen from one of its pixels.
struct RampEnd {
  float depth_mm = 0.0F;  // of the surface, continued to the pixel
  cv::Vec3f color{0, 0, 0};
};

/// A pixel of a ramp with both ends.
struct RampPixel {
  cv::Point at;
  RampEnd near;
  RampEnd far;
};

/// The pictures that all steps read.
struct RampImages {
  cv::Mat depth;
  cv::Mat color;
  cv::Mat ramp;              // CV_8UC1, 255 on ramps
  cv::Mat slope_u, slope_v;  // CV_32FC1, mm/px
  [[nodiscard]] bool contains(const cv::Point& at) const {
    return cv::Rect({0, 0}, depth.size()).contains(at) && depth.at<float>(at) > 0.0F;
  }
};

/// Returns the slope of the surfaces around each pixel: the smallest one in a window that is wider
/// than a ramp. `slope`: CV_32FC1.
cv::Mat measureSurfaceSlope(const cv::Mat& slope) {
  cv::Mat small;
  cv::resize(slope, small, {std::max(1, slope.cols / kCoarse), std::max(1, slope.rows / kCoarse)},
             0, 0, cv::INTER_AREA);
  constexpr int kWindow = 2 * (kAround_px / kCoarse) + 1;
  cv::erode(small, small, cv::Mat::ones(kWindow, kWindow, CV_8UC1));
  cv::Mat out;
  cv::resize(small, out, slope.size(), 0, 0, cv::INTER_LINEAR);
  return out;
}

RampImages findRamps(const cv::Mat& depth, const cv::Mat& color) {
  RampImages out{depth, color, cv::Mat(depth.size(), CV_8UC1), {}, {}};
  cv::Sobel(depth, out.slope_u, CV_32F, 1, 0, 3, 0.125, 0, cv::BORDER_REPLICATE);
  cv::Sobel(depth, out.slope_v, CV_32F, 0, 1, 3, 0.125, 0, cv::BORDER_REPLICATE);
  cv::Mat slope;
  cv::magnitude(out.slope_u, out.slope_v, slope);
  const cv::Mat surface = measureSurfaceSlope(slope);
  const auto pixel = static_cast<float>(1.0 / (kFocalWidths * depth.cols));
  for (int v = 0; v < depth.rows; ++v) {
    const auto* z = depth.ptr<float>(v);
    const auto* here = slope.ptr<float>(v);
    const auto* around = surface.ptr<float>(v);
    auto* ramp = out.ramp.ptr<unsigned char>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const float most = kSteep * pixel * z[u] + kTimesSurface * around[u];
      ramp[u] = z[u] > 0.0F && here[u] > most ? 255 : 0;
    }
  }
  return out;
}

/// Returns the depth of a surface `away_px` before `edge`, its last pixel, by the parabola through
/// `edge` and two pixels inside. Without these the surface is flat.
float continueSurface(const RampImages& images, const cv::Point& edge, const cv::Point& inside,
                      const cv::Point& deeper, float away_px) {
  const float edge_mm = images.depth.at<float>(edge);
  const auto isSurface = [&images](const cv::Point& at) {
    return images.contains(at) && images.ramp.at<unsigned char>(at) == 0;
  };
  if (!isSurface(inside)) return edge_mm;
  const float inside_mm = images.depth.at<float>(inside);
  const float slope = (edge_mm - inside_mm) / kInside_px;
  const float before =
      isSurface(deeper) ? (inside_mm - images.depth.at<float>(deeper)) / kInside_px : slope;
  const float bend = (slope - before) / kInside_px;
  const float way_mm =
      (slope + 0.5F * bend * kInside_px) * away_px + 0.5F * bend * away_px * away_px;
  const float most_mm =
      kSteepest * edge_mm / static_cast<float>(kFocalWidths * images.depth.cols) * away_px;
  return edge_mm + std::clamp(way_mm, -most_mm, most_mm);
}

/// Follows the ramp from `at` in the direction `step` to its end. Returns nullopt if it has none
/// within reach.
std::optional<RampEnd> findEnd(const RampImages& images, const cv::Point& at,
                               const cv::Point2f& step) {
  const auto pixelAt = [&](int distance) {
    return cv::Point(cvRound(float(at.x) + float(distance) * step.x),
                     cvRound(float(at.y) + float(distance) * step.y));
  };
  int end = 1;
  while (end <= kReach_px && images.contains(pixelAt(end)) &&
         images.ramp.at<unsigned char>(pixelAt(end)) != 0)
    ++end;
  if (end > kReach_px || !images.contains(pixelAt(end))) return std::nullopt;
  RampEnd out;
  int count = 0;
  for (; count < kSample_px && images.contains(pixelAt(end + count)); ++count)
    out.color += cv::Vec3f(images.color.at<cv::Vec3b>(pixelAt(end + count)));
  out.color /= static_cast<float>(count);
  out.depth_mm = continueSurface(images, pixelAt(end), pixelAt(end + kInside_px),
                                 pixelAt(end + 2 * kInside_px), static_cast<float>(end));
  return out;
}

/// Returns how much more the pixel's colour is that of the near end, -1 to 1. Where both ends have
/// alike colours, the middle of the ramp decides.
float compareColors(const RampImages& images, const RampPixel& pixel) {
  const cv::Vec3f color = images.color.at<cv::Vec3b>(pixel.at);
  const auto distance = [&color](const cv::Vec3f& other) {
    const cv::Vec3f off = color - other;
    return off.dot(off);
  };
  const float to_near = distance(pixel.near.color);
  const float to_far = distance(pixel.far.color);
  const float middle_mm = 0.5F * (pixel.near.depth_mm + pixel.far.depth_mm);
  const float place = images.depth.at<float>(pixel.at) < middle_mm ? kMiddle : -kMiddle;
  return (to_far - to_near) / (to_far + to_near + kColorNoise) + place;
}

std::vector<RampPixel> listRampPixels(const RampImages& images) {
  std::vector<RampPixel> out;
  std::vector<cv::Point> places;
  cv::findNonZero(images.ramp, places);
  out.reserve(places.size());
  for (const cv::Point& at : places) {
    cv::Point2f step(images.slope_u.at<float>(at), images.slope_v.at<float>(at));
    step /= std::hypot(step.x, step.y);
    const auto near = findEnd(images, at, -step);
    const auto far = findEnd(images, at, step);
    if (near && far && near->depth_mm < far->depth_mm) out.push_back({at, *near, *far});
  }
  return out;
}

}  // namespace

cv::Mat sharpenEdges(const cv::Mat& depth, const cv::Mat& color) {
  const RampImages images = findRamps(depth, color);
  const std::vector<RampPixel> pixels = listRampPixels(images);
  if (pixels.empty()) return depth;
  cv::Mat votes = cv::Mat::zeros(depth.size(), CV_32FC1);
  for (const RampPixel& pixel : pixels) votes.at<float>(pixel.at) = compareColors(images, pixel);
  cv::blur(votes, votes, {kVote_px, kVote_px});
  cv::Mat out = depth.clone();
  for (const RampPixel& pixel : pixels) {
    const bool near = votes.at<float>(pixel.at) > 0.0F;
    out.at<float>(pixel.at) = near ? pixel.near.depth_mm : pixel.far.depth_mm;
  }
  return out;
}

}  // namespace hapticast::server
