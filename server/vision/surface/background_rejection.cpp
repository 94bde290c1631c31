// SPDX-License-Identifier: MIT
#include "server/vision/surface/background_rejection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "common/geometry.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/surface/quadratic_fit.hpp"

namespace hapticast::server {

namespace {

// Measured: depth of sensors mixes object and background up to this distance.
constexpr int kRim_px = 5;
constexpr double kMixed = 0.1;     // chosen, of the pixels at an edge
constexpr double kStrange = 0.02;  // chosen, of the pixels at a rim: share of a body's corners
constexpr int kFewestBeside = 20;  // chosen: pixels that determine the inside and the surroundings
constexpr float kSameDepth_mm = 8.0F;  // chosen: neighbours of a surface without noise
constexpr int kFewestAlike = 3;        // chosen: neighbours of the same depth inside a surface
// Chosen: a ball's rim steepens by up to 1.4 times its slope for each pixel.
constexpr double kBend = 1.5;
const std::array<cv::Point, 8> kAround{
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

// Returns whether fewer than `wanted` of the eight neighbours are known and connected to this
// pixel.
// A neighbour is connected if its depth is similar or, with `slopes`, if the slope from the pixel
// behind it continues. Do not use `slopes` where mixed pixels have slopes of their own.
bool isLonely(const cv::Mat& depth, const cv::Mat& known, const cv::Point& at, double sigma,
              int wanted, bool slopes) {
  const cv::Rect whole({0, 0}, depth.size());
  // Far from the border no place needs a check.
  const bool inner = at.x > 1 && at.y > 1 && at.x + 2 < depth.cols && at.y + 2 < depth.rows;
  const auto* z = depth.ptr<float>(at.y) + at.x;
  const auto* k = known.ptr<uchar>(at.y) + at.x;
  const auto depth_row = static_cast<std::ptrdiff_t>(depth.step1());
  const auto known_row = static_cast<std::ptrdiff_t>(known.step1());
  const auto step_mm = static_cast<float>(double(kSameDepth_mm) + 5 * sigma);
  int near = 0;
  for (const cv::Point& by : kAround) {
    const std::ptrdiff_t to_z = by.y * depth_row + by.x;
    const std::ptrdiff_t to_k = by.y * known_row + by.x;
    if ((!inner && !whole.contains(at + by)) || k[to_k] == 0) continue;
    const float slope = z[0] - z[to_z];
    bool hangs = std::abs(slope) <= step_mm;
    if (!hangs && slopes && (inner || whole.contains(at + 2 * by)) && k[2 * to_k] != 0)
      hangs = std::abs(slope - z[to_z] + z[2 * to_z]) <= step_mm;
    if (hangs && ++near >= wanted) return false;
  }
  return true;
}

// Depths of the object's core and of the background, extrapolated to the rim.
struct Sides {
  int reduction = 2;
  cv::Mat object;  // CV_32FC1 at 1 / reduction; both empty if one of them is unknown
  cv::Mat behind;
  bool clean = false;  // the object's depth has no noise
  bool sharp = false;  // it is clean, and no pixel mixes object and background
  double sigma = 0.0;  // noise of the object's depth, mm

  [[nodiscard]] double objectDepth(int u, int v) const {
    return double(object.at<float>(v / reduction, u / reduction));
  }
  [[nodiscard]] double backgroundDepth(int u, int v) const {
    return double(behind.at<float>(v / reduction, u / reduction));
  }
};

bool background(double z, double object, double behind, double sigma, bool sharp) {
  const double gap = behind - object;
  if (std::abs(gap) <= 15 + 6 * sigma) return false;  // contact: depth cannot separate them
  const double off = z - object;
  const double near_behind = std::abs(z - behind);
  // The depth of a steep rim, as of a ball, differs far from the core. If no pixel is mixed, all of
  // the rim is the object's.
  if (sharp) return near_behind < std::min(std::abs(off), 3 + 4 * sigma);
  const bool same_side = off * gap > 0;
  if (same_side) return near_behind < std::abs(off) && std::abs(off) > 12 + 4 * sigma;
  return std::abs(off) > 60 + 6 * sigma;
}

// Direction inwards at the contour of a mask, as a step to one of the eight neighbours.
class Inwards {
 public:
  explicit Inwards(const cv::Mat& mask) {
    cv::Mat soft;
    cv::boxFilter(mask, soft, CV_32F, {7, 7});
    cv::Sobel(soft, along_u_, CV_32F, 1, 0);
    cv::Sobel(soft, along_v_, CV_32F, 0, 1);
  }
  [[nodiscard]] cv::Point at(int u, int v) const {
    const Vec2 way(double(along_u_.at<float>(v, u)), double(along_v_.at<float>(v, u)));
    const Vec2 unit = way.normalized();
    return {cvRound(unit.x()), cvRound(unit.y())};
  }

 private:
  cv::Mat along_u_;
  cv::Mat along_v_;
};

// Returns whether the depth at the contour of a mask continues its surface: inwards, two successive
// slopes change little, even if they are steep. A mixed pixel does not continue it.
bool continuesBeyond(const cv::Mat& depth, const cv::Point& at, const cv::Point& inwards,
                     double tolerance_mm) {
  const cv::Rect whole({0, 0}, depth.size());
  std::array<double, 4> z{};
  for (std::size_t i = 0; i < z.size(); ++i) {
    const cv::Point p = at + static_cast<int>(i) * inwards;
    if (!whole.contains(p) || depth.at<float>(p) <= 0) return false;
    z[i] = double(depth.at<float>(p));
  }
  const auto goesOn = [&](std::size_t i) {
    const double before = z[i + 1] - z[i + 2];
    return std::abs(z[i] - z[i + 1] - before) <= tolerance_mm + kBend * std::abs(before);
  };
  return goesOn(0) && goesOn(1);
}

// Returns whether hardly any pixel at the contour lies between object and background in depth.
bool haveSharpEdges(const cv::Mat& depth, const cv::Mat& mask, const Sides& sides) {
  const cv::Mat ring = dilateBy(mask, 3) & (erodeBy(mask, 2) == 0) & (depth > 0);
  const double tolerance = 12 + 4 * sides.sigma;
  const Inwards inwards(mask);
  int between = 0;
  int all = 0;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (ring.at<uchar>(v, u) == 0) continue;
      ++all;
      const auto z = double(depth.at<float>(v, u));
      if (std::abs(z - sides.backgroundDepth(u, v)) <= tolerance ||
          std::abs(z - sides.objectDepth(u, v)) <= tolerance)
        continue;
      between += continuesBeyond(depth, {u, v}, inwards.at(u, v), tolerance) ? 0 : 1;
    }
  }
  return between < kMixed * all;
}

Sides findSides(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& core_known,
                const DepthNoise& noise, int reduction) {
  const cv::Mat around = (dilateBy(mask, kRim_px) == 0) & (depth > 0);
  if (cv::countNonZero(core_known) < kFewestBeside || cv::countNonZero(around) < kFewestBeside)
    return {};
  Sides out{reduction, fillAtReducedSize(depth, core_known, reduction),
            fillAtReducedSize(depth, around, reduction)};
  const double depth_mm = cv::mean(depth, core_known)[0];
  out.sigma = noise.at(depth_mm);
  out.clean = noise.clean(depth_mm);
  out.sharp = out.clean && haveSharpEdges(depth, mask, out);
  return out;
}

}  // namespace

bool contoursAgree(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                   const DepthNoise& noise) {
  const cv::Mat rim = known & (erodeBy(mask, 2) == 0);
  const double tolerance = 12 + 4 * noise.at(cv::mean(depth, known)[0]);
  const Inwards inwards(mask);
  int strange = 0;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      if (rim.at<uchar>(v, u) != 0)
        strange += continuesBeyond(depth, {u, v}, inwards.at(u, v), tolerance) ? 0 : 1;
    }
  }
  return strange < kStrange * cv::countNonZero(rim);
}

namespace {

// Returns whether three of the four direct neighbours have nearly the same depth, whatever the
// noise. Then the pixel is not lonely, and no slower test is necessary.
bool hasCompany(const cv::Mat& depth, const cv::Mat& known, int v, int u) {
  if (v == 0 || u == 0 || v + 1 >= depth.rows || u + 1 >= depth.cols) return false;
  const auto* z = depth.ptr<float>(v) + u;
  const auto* k = known.ptr<uchar>(v) + u;
  const auto depth_row = static_cast<std::ptrdiff_t>(depth.step1());
  const auto known_row = static_cast<std::ptrdiff_t>(known.step1());
  const auto beside = [&](std::ptrdiff_t to_z, std::ptrdiff_t to_k) {
    return int(k[to_k] != 0) & int(std::abs(z[0] - z[to_z]) <= kSameDepth_mm);
  };
  return beside(-1, -1) + beside(1, 1) + beside(-depth_row, -known_row) +
             beside(depth_row, known_row) >=
         kFewestAlike;
}

}  // namespace

cv::Mat foregroundPixels(const cv::Mat& depth, const cv::Mat& mask, const cv::Mat& known,
                         const DepthNoise& noise, int reduction) {
  const cv::Mat core = erodeBy(mask, kRim_px);
  const Sides sides = findSides(depth, mask, core & known, noise, reduction + 1);
  cv::Mat keep = known.clone();
  for (int v = 0; v < depth.rows; ++v) {
    const auto* is_known = known.ptr<unsigned char>(v);
    const auto* is_core = core.ptr<unsigned char>(v);
    for (int u = 0; u < depth.cols; ++u) {
      if (is_known[u] == 0) continue;
      const bool rim = is_core[u] == 0;
      if (!rim && hasCompany(depth, known, v, u)) continue;
      const auto z = double(depth.at<float>(v, u));
      // On clean depth the apparent noise of a steep rim is its curvature.
      const double sigma = sides.sharp ? sides.sigma : noise.at(z);
      const bool drop =
          (rim && !sides.object.empty() &&
           background(z, sides.objectDepth(u, v), sides.backgroundDepth(u, v), sigma,
                      sides.sharp)) ||
          (!(rim && sides.sharp) &&
           isLonely(depth, known, {u, v}, sigma, rim ? 2 : kFewestAlike, !rim && sides.clean));
      if (drop) keep.at<unsigned char>(v, u) = 0;
    }
  }
  return keep;
}

}  // namespace hapticast::server
