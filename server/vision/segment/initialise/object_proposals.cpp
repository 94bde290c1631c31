// SPDX-License-Identifier: MIT
#include "server/vision/segment/initialise/object_proposals.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"

namespace hapticast::server {

namespace {

// Chosen, of the picture: limits of an object, and of a limb with its body.
constexpr double kLeastObject = 0.006;
constexpr double kMostObject = 0.3;
constexpr double kMostBody = 0.7;
constexpr double kCompact = 0.35;  // chosen, of the bounding box
// Chosen: width of the picture in which geodesic distances are measured; and the end of a limb, as
// a part of the largest distance.
constexpr double kGeodesic_px = 160.0;
constexpr double kEndOfLimb = 0.6;
constexpr double kLeastOfEnd = 0.1;  // chosen, of the end: least share of what is no skin
constexpr double kSamePlace = 0.03;  // chosen, of the picture's width
constexpr std::size_t kMostProposals = 6;

struct Component {
  cv::Mat mask;
  double depth_mm = 0.0;
  bool is_compact = false, at_border = false;
};

// Returns whether there are enough well exposed corners to track.
bool hasTexture(const FrameImages& images, const cv::Mat& mask) {
  std::vector<cv::Point2f> corners;
  const cv::Rect box = findBoxAround(mask, 0);
  const cv::Mat exposed = erodeBy(mask(box), 2) & (images.gray(box) > 8) & (images.gray(box) < 247);
  if (2 * cv::countNonZero(exposed) < cv::countNonZero(mask)) return false;
  cv::goodFeaturesToTrack(images.gray(box), corners, 30, 0.03, 4.0, exposed);
  return corners.size() >= 12;
}

// Returns the components of at least kLeastObject of the picture, the nearest first.
std::vector<Component> listComponents(const FrameImages& images, const cv::Mat& labels) {
  struct Region {
    int area = 0, left = 1 << 20, right = 0, top = 1 << 20, bottom = 0;
  };
  std::vector<Region> regions(labels.total() + 1);
  for (int v = 0; v < labels.rows; ++v) {
    for (int u = 0; u < labels.cols; ++u) {
      Region& r = regions[static_cast<std::size_t>(labels.at<int>(v, u))];
      r = {r.area + 1, std::min(r.left, u), std::max(r.right, u), std::min(r.top, v), v};
    }
  }
  const auto whole = double(labels.total());
  std::vector<Component> out;
  for (std::size_t i = 1; i < regions.size(); ++i) {
    const Region& r = regions[i];
    if (r.area < kLeastObject * whole || r.area > kMostBody * whole) continue;
    Component next{labels == static_cast<double>(i)};
    const double box = double(r.right - r.left + 1) * (r.bottom - r.top + 1);
    next.at_border = !clearOfBorder(next.mask);
    next.is_compact = !next.at_border && r.area <= kMostObject * whole && r.area >= kCompact * box;
    next.depth_mm = medianDepth(images.depth, next.mask, 2);
    if (next.depth_mm > 0) out.push_back(std::move(next));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Component& a, const Component& b) { return a.depth_mm < b.depth_mm; });
  return out;
}

// Returns the number of steps inside `mask` from the picture's border to each pixel, CV_32SC1; 0
// outside the mask and where no path leads from the border.
cv::Mat countStepsFromBorder(const cv::Mat& mask) {
  cv::Mat steps = cv::Mat::zeros(mask.size(), CV_32SC1);
  std::queue<cv::Point> next;
  const auto visit = [&](const cv::Point& at, int count) {
    if (!contains(mask, at) || steps.at<int>(at) != 0) return;
    steps.at<int>(at) = count;
    next.push(at);
  };
  for (int u = 0; u < mask.cols; ++u) {
    visit({u, 0}, 1);
    visit({u, mask.rows - 1}, 1);
  }
  for (int v = 0; v < mask.rows; ++v) {
    visit({0, v}, 1);
    visit({mask.cols - 1, v}, 1);
  }
  while (!next.empty()) {
    const cv::Point at = next.front();
    next.pop();
    for (const cv::Point& way :
         {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)})
      visit(at + way, steps.at<int>(at) + 1);
  }
  return steps;
}

// Returns the part of a limb that is farthest from the picture's border along the limb, 0/255.
cv::Mat findEndOfLimb(const cv::Mat& limb) {
  const double shrink = std::min(1.0, kGeodesic_px / std::max(limb.cols, limb.rows));
  cv::Mat small;
  cv::resize(limb, small, {}, shrink, shrink, cv::INTER_AREA);
  const cv::Mat steps = countStepsFromBorder(small > 127);
  double most = 0.0;
  cv::minMaxLoc(steps, nullptr, &most);
  cv::Mat end = steps > kEndOfLimb * most;
  cv::resize(end, end, limb.size(), 0, 0, cv::INTER_NEAREST);
  return end & limb;
}

// `skin`: 255 where the picture has colours of skin.
void addEndOfLimb(const cv::Mat& depth, const cv::Mat& skin, const Component& limb,
                  std::vector<ObjectProposal>& out) {
  const cv::Mat end = findEndOfLimb(limb.mask);
  const auto add = [&](const cv::Mat& region) {
    const cv::Point at = findDeepestPoint(region);
    const bool is_known = std::any_of(out.begin(), out.end(), [&](const ObjectProposal& other) {
      return cv::norm(other.at - at) < kSamePlace * region.cols;
    });
    if (!is_known) out.push_back({at, medianDepth(depth, region, 2), true});
  };
  add(end);
  const cv::Mat thing = end & ~skin;
  if (cv::countNonZero(thing) > kLeastOfEnd * cv::countNonZero(end)) add(thing);
}

}  // namespace

cv::Mat findNearestCompact(const FrameImages& images, const cv::Mat& labels) {
  for (const Component& each : listComponents(images, labels)) {
    if (each.is_compact && hasTexture(images, each.mask)) return each.mask;
  }
  return {};
}

std::vector<ObjectProposal> proposeObjects(const FrameContext& scene, const cv::Mat& labels) {
  const cv::Mat skin = scene.skin.findSkin(scene.images.color);
  std::vector<ObjectProposal> out;
  for (const Component& each : listComponents(scene.images, labels)) {
    if (out.size() >= kMostProposals) break;
    if (each.at_border) {
      addEndOfLimb(scene.images.depth, skin, each, out);
    } else if (each.is_compact && hasTexture(scene.images, each.mask)) {
      out.push_back({findDeepestPoint(each.mask), each.depth_mm, false});
    }
  }
  if (out.size() > kMostProposals) out.resize(kMostProposals);
  return out;
}

}  // namespace hapticast::server
