// SPDX-License-Identifier: MIT
#include "server/vision/segment/make_segmenter.hpp"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "server/vision/segment/follow/narrow_band_tracker.hpp"

namespace hapticast::server {

namespace {

// Counts the pixels of each value. Neighbours often have equal values, so four counters avoid a
// dependency between successive increments.
std::array<int, 256> countLabelPixels(const cv::Mat& mask) {
  std::array<std::array<int, 256>, 4> counts{};
  for (int v = 0; v < mask.rows; ++v) {
    const auto* row = mask.ptr<unsigned char>(v);
    for (int u = 0; u < mask.cols; ++u) ++counts[static_cast<std::size_t>(u) % 4][row[u]];
  }
  for (std::size_t value = 0; value < 256; ++value)
    counts[0][value] += counts[1][value] + counts[2][value] + counts[3][value];
  return counts[0];
}

// Uses the source's masks unchanged: all objects, or the objects under the author's points of the
// first frame.
class SourceSegmenter final : public Segmenter {
 public:
  SourceSegmenter(std::vector<AuthorPoint> points, std::uint32_t& next_id)
      : points_(std::move(points)), next_id_(next_id) {}

  std::vector<Segment> next(const FramePair& frames, const Flows& /*flows*/) override {
    const FrameImages& images = frames.now;
    if (frames.cut) ids_.clear();
    if (images.mask.empty())
      throw SourceError("--segment source: the source brings no mask; use --segment auto");
    if (!points_.empty()) choose(images);
    const std::array<int, 256> area = countLabelPixels(images.mask);
    std::vector<Segment> segments;
    for (std::size_t n = 1; n < area.size(); ++n) {
      if (area[n] < kSmallestObject_px) {
        ids_.erase(n);
      } else if (segments.size() < kMaxObjects && (chosen_.empty() || chosen_.contains(n))) {
        const auto [known, is_new] = ids_.try_emplace(n, next_id_);
        if (is_new) ++next_id_;
        const auto number = chosen_.empty() ? static_cast<int>(n) : chosen_.at(n);
        segments.push_back({known->second, images.mask == static_cast<double>(n), 1.0, number});
      }
    }
    return segments;
  }

 private:
  void choose(const FrameImages& images) {
    for (const AuthorPoint& point : points_) {
      const cv::Point at(static_cast<int>(point.at_px.x()), static_cast<int>(point.at_px.y()));
      const auto value = images.mask.at<unsigned char>(at);
      if (value == 0) throwNoObject(point.at_px, "the source's mask has no object there");
      if (cv::countNonZero((images.mask == double(value)) & (images.depth > 0)) == 0)
        throwNoObject(point.at_px, "no depth was measured on that object");
      chosen_.try_emplace(value, point.number);
    }
    points_.clear();
  }

  std::vector<AuthorPoint> points_;    // cleared in the first frame
  std::map<std::size_t, int> chosen_;  // numbers of the objects, by value of the mask; empty: all
  std::uint32_t& next_id_;
  std::map<std::size_t, std::uint32_t> ids_;  // of the present objects
};

}  // namespace

std::unique_ptr<Segmenter> makeSegmenter(const VisionSettings& settings, bool has_mask,
                                         std::uint32_t& next_id, ClipAnnotations* annotations) {
  SegmentMode mode = settings.segment;
  if (mode == SegmentMode::kAuto && has_mask) mode = SegmentMode::kSource;
  if (mode == SegmentMode::kAuto && settings.method == Method::kThesis) mode = SegmentMode::kEdges;
  if (mode == SegmentMode::kSource)
    return std::make_unique<SourceSegmenter>(settings.pointsAtStart(), next_id);
  if (mode == SegmentMode::kEdges) return makeEdgeSegmenter(settings, next_id);
  return std::make_unique<NarrowBandTracker>(settings, next_id, annotations);
}

}  // namespace hapticast::server
