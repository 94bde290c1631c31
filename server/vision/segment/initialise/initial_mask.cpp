// SPDX-License-Identifier: MIT
#include "server/vision/segment/initialise/initial_mask.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"
#include "server/vision/segment/appearance/graph_cut.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr int kLongestHole_px = 24;    // chosen: the sensors' shadows are narrower
constexpr double kSurelyGround = 0.2;  // chosen, of the picture
constexpr int kNear_px = 12;           // chosen: largest distance of a component from the point

// Interpolates holes in one line of pixels (stride apart) linearly if both sides agree.
void bridgeLine(float* line, std::ptrdiff_t stride, int count, const DepthNoise& noise) {
  int last = -1;
  for (int i = 0; i < count; ++i) {
    const float z = line[i * stride];
    if (z <= 0.0F) continue;
    const int gap = i - last;
    if (last >= 0 && gap > 1 && gap <= kLongestHole_px) {
      const float before = line[last * stride];
      if (std::abs(double(z) - double(before)) < std::max(25.0, 10 * noise.at(double(z)))) {
        for (int k = 1; k < gap; ++k) {
          line[(last + k) * stride] = before + (z - before) * float(k) / float(gap);
        }
      }
    }
    last = i;
  }
}

int findRoot(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    auto& up = parent[static_cast<std::size_t>(i)];
    up = parent[static_cast<std::size_t>(up)];
    i = up;
  }
  return i;
}

cv::Mat cleanComponent(const cv::Mat& component) {
  cv::Mat mask;
  const cv::Mat disc2 = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  const cv::Mat disc1 = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::morphologyEx(component, mask, cv::MORPH_CLOSE, disc2);
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, disc1);
  return fillHolesOf(mask, mask.rows * mask.cols / 100);
}

// Marks the negative points for GrabCut (its corner is at `origin`). Their object may be connected
// to the object in depth, so it must not count as certain foreground.
void markNot(const cv::Point& object, const std::vector<cv::Point>& not_points,
             const cv::Point& origin, cv::Mat& marks) {
  const auto square = [](const cv::Point& p) { return p.dot(p); };
  for (const cv::Point& point : not_points) {
    for (int v = 0; v < marks.rows; ++v) {
      auto* row = marks.ptr<unsigned char>(v);
      for (int u = 0; u < marks.cols; ++u) {
        const cv::Point at(u, v);
        if (row[u] != cv::GC_BGD && square(at - (point - origin)) < square(at - object))
          row[u] = cv::GC_PR_BGD;
      }
    }
  }
  for (const cv::Point& point : not_points)
    cv::circle(marks, point - origin, 10, cv::GC_BGD, cv::FILLED);
}

int findLabelNear(const cv::Mat& labels, const cv::Point& point) {
  int best = 0;
  int best_square = kNear_px * kNear_px + 1;
  const cv::Rect around =
      cv::Rect(point.x - kNear_px, point.y - kNear_px, 2 * kNear_px + 1, 2 * kNear_px + 1) &
      cv::Rect({0, 0}, labels.size());
  for (int v = around.y; v < around.br().y; ++v) {
    for (int u = around.x; u < around.br().x; ++u) {
      const int square = (u - point.x) * (u - point.x) + (v - point.y) * (v - point.y);
      if (labels.at<int>(v, u) != 0 && square < best_square) {
        best = labels.at<int>(v, u);
        best_square = square;
      }
    }
  }
  return best;
}

}  // namespace

cv::Mat depthComponents(const cv::Mat& depth, const cv::Mat& excluded, const DepthNoise& noise) {
  cv::Mat bridged = depth.clone();
  for (int v = 0; v < depth.rows; ++v) bridgeLine(bridged.ptr<float>(v), 1, depth.cols, noise);
  const auto stride = static_cast<std::ptrdiff_t>(bridged.step1());
  for (int u = 0; u < depth.cols; ++u)
    bridgeLine(bridged.ptr<float>(0) + u, stride, depth.rows, noise);
  bridged.setTo(0, excluded);
  std::vector<int> parent(static_cast<std::size_t>(depth.total()));
  std::iota(parent.begin(), parent.end(), 0);
  for (int v = 0; v < depth.rows; ++v) {
    const auto* row = bridged.ptr<float>(v);
    const auto* above = v > 0 ? bridged.ptr<float>(v - 1) : nullptr;
    for (int u = 0; u < depth.cols; ++u) {
      if (row[u] <= 0) continue;
      const double step = noise.step_mm(double(row[u]));
      const int here = v * depth.cols + u;
      const auto join = [&](float z, int there) {
        if (z <= 0 || std::abs(double(z) - double(row[u])) > step) return;
        parent[static_cast<std::size_t>(findRoot(parent, here))] = findRoot(parent, there);
      };
      if (u > 0) join(row[u - 1], here - 1);
      if (above != nullptr) join(above[u], here - depth.cols);
    }
  }
  cv::Mat labels(depth.size(), CV_32S);
  for (int i = 0; i < static_cast<int>(depth.total()); ++i) {
    const int v = i / depth.cols;
    const int u = i % depth.cols;
    labels.at<int>(v, u) = bridged.at<float>(v, u) > 0 ? findRoot(parent, i) + 1 : 0;
  }
  return labels;
}

int countBorderPixels(const cv::Mat& mask) {
  return cv::countNonZero(mask.row(0)) + cv::countNonZero(mask.row(mask.rows - 1)) +
         cv::countNonZero(mask.col(0)) + cv::countNonZero(mask.col(mask.cols - 1));
}

bool clearOfBorder(const cv::Mat& mask) {
  return countBorderPixels(mask) <= 0.1 * std::sqrt(double(cv::countNonZero(mask)));
}

ObjectStart findObject(const cv::Mat& depth, const cv::Point& point, const DepthNoise& noise,
                       std::vector<Plane> planes) {
  const cv::Rect whole({0, 0}, depth.size());
  const cv::Rect around = cv::Rect(point.x - 2, point.y - 2, 5, 5) & whole;
  const double range = medianDepth(depth(around), depth(around) > 0, 1);
  if (range > 0) {
    const auto through = [&](const Plane& plane) {
      return std::abs(plane.behind(point.x, point.y, range)) <= 1.0;
    };
    const bool on_ground = std::any_of(planes.begin(), planes.end(), [&](const Plane& plane) {
      return through(plane) && plane.share > kSurelyGround;
    });
    std::erase_if(planes, through);
    if (on_ground)
      return {{}, "the point is on the plane that carries the objects", false, std::move(planes)};
  }
  cv::Mat mask;
  for (int round = 0; round < 2; ++round) {  // the second round has the supports
    const cv::Mat labels = depthComponents(depth, findOnPlanes(depth, whole, planes), noise);
    const int label = findLabelNear(labels, point);
    if (label == 0) return {{}, "there is no depth", false, std::move(planes)};
    mask = cleanComponent(labels == label);
    findSupports(depth, mask, planes);
  }
  if (cv::countNonZero(mask) < kSmallestObject_px)
    return {{}, "there are too few pixels", true, std::move(planes)};
  return {mask, nullptr, false, std::move(planes)};
}

cv::Mat cutByColor(const FrameImages& images, const cv::Mat& mask, const std::vector<Plane>& planes,
                   const cv::Point& object_point, const std::vector<cv::Point>& not_points) {
  const cv::Rect box = findBoxAround(mask, 60);
  cv::Mat marks(box.size(), CV_8UC1, cv::Scalar(cv::GC_PR_BGD));
  marks.setTo(cv::GC_PR_FGD, mask(box));
  marks.setTo(cv::GC_BGD, dilateBy(mask(box), 30) == 0);
  marks.setTo(cv::GC_BGD, findOnPlanes(images.depth, box, planes) & (mask(box) == 0));
  cv::Mat inner;
  cv::distanceTransform(mask(box), inner, cv::DIST_L2, 3);
  double deepest = 0.0;
  cv::minMaxLoc(inner, nullptr, &deepest);
  marks.setTo(cv::GC_FGD, inner > std::clamp(0.3 * deepest, 5.0, 10.0));
  markNot(object_point - box.tl(), not_points, box.tl(), marks);
  const double shrink = std::min(0.5, std::sqrt(kCutOfClick.most_px / box.area()));
  const cv::Size half(std::max(8, int(box.width * shrink)), std::max(8, int(box.height * shrink)));
  cv::Mat color;
  cv::resize(images.color(box), color, half, 0, 0, cv::INTER_AREA);
  cv::resize(marks, marks, half, 0, 0, cv::INTER_NEAREST);
  const int confident = cv::countNonZero(marks == cv::GC_FGD);
  const int uncertain = cv::countNonZero((marks == cv::GC_BGD) | (marks == cv::GC_PR_BGD));
  if (confident < 20 || uncertain < 20) return mask;  // GrabCut needs both
  cv::Mat background;
  cv::Mat foreground;
  cv::setRNGSeed(7);
  cv::grabCut(color, marks, {}, background, foreground, kCutOfClick.rounds, cv::GC_INIT_WITH_MASK);
  cv::Mat cut = (marks == cv::GC_FGD) | (marks == cv::GC_PR_FGD);
  cv::resize(cut, cut, box.size(), 0, 0, cv::INTER_LINEAR);
  cut = cut > 127;
  const double ratio = double(cv::countNonZero(cut)) / cv::countNonZero(mask);
  if (ratio < (not_points.empty() ? 0.4 : 0.1) || ratio > 2.5) return mask;
  cv::Mat out = cv::Mat::zeros(mask.size(), CV_8UC1);
  cut.copyTo(out(box));
  return out;
}

}  // namespace hapticast::server
