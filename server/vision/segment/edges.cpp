// SPDX-License-Identifier: MIT
// Edge-based segmentation of the thesis: fuses Canny edges (Canny 1986) of colour and depth, closes
// them, and labels the enclosed regions.
// It serves as the thesis's own row of the evaluation. Real scenes need the narrow-band tracker
// (follow/narrow_band_tracker.hpp). Thread: the one that runs Vision.
#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/initialise/object_proposals.hpp"
#include "server/vision/segment/make_segmenter.hpp"

namespace hapticast::server {

namespace {

// One setting for all scenes. Chosen: the thesis states none.
constexpr double kDepthNear_mm = 300.0;
constexpr double kDepthFar_mm = 2500.0;
constexpr int kEdge_px = 2;  // half the width of a closed edge

// Returns 1 where there is no edge, so that the picture splits into regions.
cv::Mat labelRegions(const FrameImages& images) {
  cv::Mat smooth;
  cv::GaussianBlur(images.gray, smooth, {}, 1.2);
  cv::Mat color_edges;
  cv::Canny(smooth, color_edges, 50, 120);
  cv::Mat depth;
  const double gain = -255.0 / (kDepthFar_mm - kDepthNear_mm);
  images.depth.convertTo(depth, CV_8U, gain, -gain * kDepthFar_mm);
  depth.setTo(0, images.depth <= 0.0);
  cv::medianBlur(depth, depth, 5);
  cv::Mat depth_edges;
  cv::Canny(depth, depth_edges, 8, 20);
  cv::Mat edges = color_edges | depth_edges;
  cv::morphologyEx(edges, edges, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {7, 7}));
  return edges == 0;
}

class EdgeSegmenter final : public Segmenter {
 public:
  EdgeSegmenter(const VisionSettings& settings, std::uint32_t& next_id)
      : points_(settings.pointsAtStart()), next_id_(next_id) {}

  std::vector<Segment> next(const FramePair& frames, const Flows& flows) override {
    const FrameImages& images = frames.now;
    if (frames.cut) forgetScene();
    const int count = cv::connectedComponents(labelRegions(images), labels_, 4, CV_32S);
    if (!started_) {
      start(images);
    } else {
      for (Segment& segment : objects_) update(segment, flows, count);
      shareOut();
      std::erase_if(objects_, [](const Segment& s) { return s.quality <= 0.0; });
      if (objects_.empty()) started_ = !points_.empty();
    }
    return objects_;
  }

 private:
  void forgetScene() {
    objects_.clear();
    started_ = started_ && !points_.empty();
  }

  cv::Mat selectRegion(int label) const {
    const cv::Mat mask = dilateBy(labels_ == label, kEdge_px);
    return fillHolesOf(mask, mask.rows * mask.cols / 4);
  }

  void start(const FrameImages& images) {
    std::set<int> started;
    for (const AuthorPoint& author_point : points_) {
      const Vec2& point = author_point.at_px;
      const int label =
          findNearestLabel({static_cast<int>(point.x()), static_cast<int>(point.y())});
      if (label == 0) throwNoObject(point, "only edges there");
      if (!started.insert(label).second) continue;  // two points on one body mark one object
      objects_.push_back({next_id_++, selectRegion(label), 1.0, author_point.number});
    }
    if (points_.empty()) {
      const cv::Mat compact = findNearestCompact(images, labels_);
      if (!compact.empty())
        objects_.push_back({next_id_++, selectRegion(findLabelUnder(compact)), 1.0, 1});
    }
    shareOut();
    started_ = !objects_.empty();
  }

  // No pixel belongs to two objects: the first object owns a shared pixel.
  void shareOut() {
    for (std::size_t later = 1; later < objects_.size(); ++later) {
      Segment& object = objects_[later];
      for (std::size_t first = 0; first < later; ++first) {
        const cv::Mat rest = object.mask & ~objects_[first].mask;
        object.mask = rest;
      }
      if (cv::countNonZero(object.mask) < kSmallestObject_px) object.quality = 0.0;
    }
  }

  int findNearestLabel(const cv::Point& point) const {
    for (int radius = 0; radius <= 12; ++radius) {
      for (int v = point.y - radius; v <= point.y + radius; ++v) {
        for (int u = point.x - radius; u <= point.x + radius; ++u) {
          if (!cv::Rect({0, 0}, labels_.size()).contains({u, v})) continue;
          if (labels_.at<int>(v, u) != 0) return labels_.at<int>(v, u);
        }
      }
    }
    return 0;
  }

  int findLabelUnder(const cv::Mat& mask) const {
    double largest = 0;
    cv::Mat inside;
    labels_.copyTo(inside, mask);
    cv::minMaxLoc(inside, nullptr, &largest);
    return static_cast<int>(largest);
  }

  // Selects the region that shares most pixels with the warped mask.
  void update(Segment& segment, const Flows& flows, int count) {
    cv::Mat carried = segment.mask;
    if (const auto flow = flows.find(segment.id); flow != flows.end()) {
      const cv::Rect whole({0, 0}, carried.size());
      carried = warpImage(segment.mask, whole, whole, flow->second.similarity, cv::INTER_NEAREST);
    }
    std::vector<int> shared(static_cast<std::size_t>(count), 0);
    for (int v = 0; v < carried.rows; ++v) {
      for (int u = 0; u < carried.cols; ++u) {
        if (carried.at<unsigned char>(v, u) != 0)
          ++shared[static_cast<std::size_t>(labels_.at<int>(v, u))];
      }
    }
    shared[0] = 0;
    const auto best = std::max_element(shared.begin(), shared.end());
    if (*best >= kSmallestObject_px) {
      segment.mask = selectRegion(static_cast<int>(best - shared.begin()));
      segment.quality = 1.0;
    } else {
      segment.mask = carried;
      segment.quality -= 0.2;
    }
    if (cv::countNonZero(segment.mask) < kSmallestObject_px) segment.quality = 0.0;
  }

  std::vector<AuthorPoint> points_;
  std::uint32_t& next_id_;
  std::vector<Segment> objects_;
  cv::Mat labels_;
  bool started_ = false;
};

}  // namespace

std::unique_ptr<Segmenter> makeEdgeSegmenter(const VisionSettings& settings,
                                             std::uint32_t& next_id) {
  return std::make_unique<EdgeSegmenter>(settings, next_id);
}

}  // namespace hapticast::server
