// SPDX-License-Identifier: MIT
// Real objects: a careful start, then the mask carried with the object and a band around its
// contour decided anew in every frame; lost, looked for by its colours, found again under a new id.
#include <algorithm>
#include <opencv2/core.hpp>

#include "server/vision/segment/contour.hpp"
#include "server/vision/segment/search.hpp"
#include "server/vision/segment/segment.hpp"
#include "server/vision/segment/start.hpp"

namespace hapticast::server {

namespace {

constexpr int kSettleRounds = 25;
constexpr int kWeakFrames = 5;   // in a row: then the object is lost
constexpr int kSearchEvery = 3;  // frames between two searches for a lost object
constexpr int kForgetAfter =
    15;  // frames lost, until an object chosen by itself is given up for another
constexpr double kMostlySeen = 0.6;  // of the whole: what is seen less teaches nothing

struct Tracked {
  std::uint32_t id = 0;
  cv::Mat mask;
  cv::Mat whole;  // mask and what of the object something nearer hides
  ContourMemory memory;
  double quality = 1.0;
  int weak = 0;        // frames in a row that did not convince
  int lost = 0;        // frames since it was lost; 0: present
  double area_px = 0;  // when last seen well
  DepthSpan depth;
};

}  // namespace

struct BandStart {
  cv::Mat color;
  cv::Mat depth;
  std::vector<Tracked> objects;
  std::vector<Plane> planes;
  DepthNoise noise;
};

namespace {

class BandSegmenter final : public Segmenter {
 public:
  BandSegmenter(const VisionSettings& settings, std::uint32_t& next_id, RememberedStart* remembered)
      : points_(settings.object_points_px), next_id_(next_id), remembered_(remembered) {
    for (const Vec2& point : settings.not_points_px) {
      not_points_.emplace_back(static_cast<int>(point.x()), static_cast<int>(point.y()));
    }
  }

  std::vector<Segment> next(const View& view, const Flows& flows) override {
    if (frame_ > 0 || !recall(view)) decide(view, flows);
    ++frame_;
    std::vector<Segment> out;
    for (const Tracked& object : objects_) {
      if (object.lost == 0) out.push_back({object.id, object.mask.clone(), object.quality});
    }
    return out;
  }

  void sceneCut() override {
    new_scene_ = true;
    if (points_.empty()) objects_.clear();
    for (Tracked& object : objects_) loose(object);
  }

 private:
  void decide(const View& view, const Flows& flows) {
    followScene(view);
    for (Tracked& object : objects_) {
      if (object.lost == 0) {
        const auto flow = flows.find(object.id);
        if (flow != flows.end() && flow->second.stays) continue;
        follow(object, view, flow != flows.end() ? flow->second : ObjectFlow{});
      } else {
        search(object, view);
      }
    }
    shareOut();
    if (frame_ == 0) startAtPoints(view);
    if (points_.empty()) chooseByItself(view);
    if (frame_ == 0) remember(view);
  }

  void remember(const View& view) const {
    if (remembered_ == nullptr) return;
    *remembered_ = std::make_shared<BandStart>(
        BandStart{view.color.clone(), view.depth.clone(), objects_, planes_, noise_});
  }

  // The same first frame again has the same start, but for the ids.
  bool recall(const View& view) {
    if (remembered_ == nullptr || *remembered_ == nullptr) return false;
    const BandStart& start = **remembered_;
    if (!equalImages(start.color, view.color) || !equalImages(start.depth, view.depth))
      return false;
    objects_ = start.objects;
    for (Tracked& object : objects_) object.id = next_id_++;
    planes_ = start.planes;
    noise_ = start.noise;
    new_scene_ = false;
    return true;
  }

  void followScene(const View& view) {
    if (new_scene_) noise_ = measureNoise(view.depth);
    if (!new_scene_ && refitPlanes(view.depth, planes_)) return;
    if (!new_scene_ && frame_ - planes_frame_ < 5) return;
    new_scene_ = false;
    planes_ = findPlanes(view.depth, noise_);
    for (const Tracked& object : objects_) removePlanesOf(object, view);
    planes_frame_ = frame_;
  }

  // A plane found anew that is the object itself, and which of them it stands on.
  void removePlanesOf(const Tracked& object, const View& view) {
    if (object.lost > 0) return;
    const double area = cv::countNonZero(object.mask & (view.depth > 0));
    const cv::Rect whole({0, 0}, view.depth.size());
    std::erase_if(planes_, [&](Plane plane) {
      plane.support = false;
      return cv::countNonZero(onPlanes(view.depth, whole, {plane}) & object.mask) > 0.3 * area;
    });
    findSupports(view.depth, object.mask, planes_);
  }

  void startAtPoints(const View& view) {
    for (const Vec2& point : points_) {
      const cv::Point at(static_cast<int>(point.x()), static_cast<int>(point.y()));
      std::vector<Plane> planes = planes_;
      const Found found = objectAt(view.depth, at, noise_, planes);
      if (found.why_not != nullptr) throwNothingAt(point, found.why_not);
      begin(view, found.mask, at, planes);
    }
  }

  void chooseByItself(const View& view) {
    const bool given_up = !objects_.empty() && objects_[0].lost > kForgetAfter;
    if ((!objects_.empty() && !given_up) || frame_ % kSearchEvery != 0) return;
    std::vector<Plane> planes = planes_;
    const cv::Rect whole({0, 0}, view.depth.size());
    const cv::Mat labels = depthComponents(view.depth, onPlanes(view.depth, whole, planes), noise_);
    const cv::Mat mask = nearestCompact(view, labels);
    if (mask.empty()) return;
    objects_.clear();
    findSupports(view.depth, mask, planes);
    const cv::Rect box = boxAround(mask, 0);
    begin(view, mask, (box.tl() + box.br()) / 2, planes);
  }

  void begin(const View& view, const cv::Mat& first_mask, const cv::Point& point,
             const std::vector<Plane>& planes) {
    planes_ = planes;
    Tracked object;
    object.id = next_id_++;
    object.mask = cutByColor(view, first_mask, planes, point, not_points_);
    object.whole = object.mask;
    settle(view, object);
    objects_.push_back(object);
  }

  // The band step on one frame until the mask comes to rest.
  void settle(const View& view, Tracked& object) {
    for (int round = 0; round < kSettleRounds; ++round) {
      const Patch patch = patchAround(view, object.mask);
      if (patch.empty()) return;
      object.memory = {};
      learn(patch, object.mask(patch.box), object.memory);
      const cv::Mat mask = decideContour(patch, noise_, planes_, object.memory).mask;
      const int changed = cv::countNonZero(mask != object.mask(patch.box));
      const int area = cv::countNonZero(mask);
      if (area < kSmallestObject_px) break;
      object.mask = wholePicture(mask, patch, view);
      if (changed < 0.004 * area) break;
    }
    const Patch patch = patchAround(view, object.mask);
    object.memory = {};
    learn(patch, object.mask(patch.box), object.memory);
    object.whole = object.mask;
    seenWell(object, patch, patch.inside);
  }

  void seenWell(Tracked& object, const Patch& patch, const cv::Mat& inside) const {
    const double area = cv::countNonZero(object.whole(patch.box));
    // One that leaves the picture has not become smaller.
    if (clearOfBorder(object.whole) || area > object.area_px) object.area_px = area;
    if (const auto depth = depthSpan(patch, inside)) object.depth = *depth;
    object.quality = 1.0;
    object.weak = 0;
  }

  void follow(Tracked& object, const View& view, const ObjectFlow& flow) {
    const Patch patch =
        patchAround(view, object.whole, flow.similarity, object.depth.nearest_mm(noise_));
    if (patch.empty()) {
      loose(object);
      return;
    }
    carryEvidence(object.memory, patch, flow.similarity);
    const ContourResult now = decideContour(patch, noise_, planes_, object.memory);
    const double expected = cv::countNonZero(patch.inside) * patch.factor * patch.factor;
    const double area = cv::countNonZero(now.mask);
    if (area < kSmallestObject_px || expected < kSmallestObject_px) {
      loose(object);
      return;
    }
    const double ratio = area / expected;
    const bool convincing = ratio >= 0.8 && ratio <= 1.25 && now.inside_color >= 0.0;
    const cv::Mat seen = convincing ? now.mask : atFullSize(patch.inside, patch);
    object.mask = wholePicture(seen, patch, view);
    object.whole = object.mask;
    const double hidden = patch.hidden.empty() ? 0.0 : cv::countNonZero(patch.hidden);
    if (hidden > 0)
      object.whole = wholePicture(seen | atFullSize(patch.hidden, patch), patch, view);
    if (!convincing) {
      object.quality *= 0.7;
      const bool leaving = !clearOfBorder(object.mask);
      if (++object.weak > kWeakFrames || leaving) loose(object);
      return;
    }
    seenWell(object, patch, patch.inside);
    if (!flow.reliable) object.quality = 0.7;
    if (expected > kMostlySeen * object.area_px) learn(patch, now.mask, object.memory);
  }

  // No pixel belongs to two objects: where they touch, the first has it.
  void shareOut() {
    for (std::size_t later = 1; later < objects_.size(); ++later) {
      for (std::size_t first = 0; first < later; ++first) {
        if (objects_[later].lost > 0 || objects_[first].lost > 0) continue;
        cv::Mat& mask = objects_[later].mask;
        mask = mask & ~objects_[first].mask;
        if (cv::countNonZero(mask) < kSmallestObject_px) loose(objects_[later]);
      }
    }
  }

  static void loose(Tracked& object) {
    object.lost = 1;
    object.quality = 0.0;
  }

  // Over the whole picture, from the first colours and the last depth.
  void search(Tracked& object, const View& view) {
    if (object.lost++ % kSearchEvery != 0) return;
    const cv::Mat candidate =
        likeliestPlace(view, object.memory.first, object.depth.middle_mm, object.area_px);
    if (candidate.empty()) return;
    Tracked again;
    again.mask = candidate;
    again.memory.first = object.memory.first;
    Patch patch;
    for (int round = 0; round < kSettleRounds; ++round) {
      again.memory.evidence.release();
      patch = patchAround(view, again.mask);
      if (patch.empty()) return;
      learn(patch, again.mask(patch.box), again.memory);
      const ContourResult now = decideContour(patch, noise_, planes_, again.memory);
      const int changed = cv::countNonZero(now.mask != again.mask(patch.box));
      const int area = cv::countNonZero(now.mask);
      if (area < kSmallestObject_px || now.inside_color < 0.5) return;
      again.mask = wholePicture(now.mask, patch, view);
      if (changed < 0.004 * area) break;
    }
    const double ratio = cv::countNonZero(again.mask) / object.area_px;
    if (ratio < 0.3 || ratio > 2.5 || !clearOfBorder(again.mask)) return;
    again.id = next_id_++;
    again.whole = again.mask;
    seenWell(again, patch, patch.inside);
    object = again;
  }

  std::vector<Vec2> points_;
  std::vector<cv::Point> not_points_;
  std::uint32_t& next_id_;
  RememberedStart* remembered_;
  DepthNoise noise_;
  std::vector<Plane> planes_;
  std::vector<Tracked> objects_;
  int frame_ = 0;
  int planes_frame_ = 0;
  bool new_scene_ = true;
};

}  // namespace

std::unique_ptr<Segmenter> makeBandSegmenter(const VisionSettings& settings, std::uint32_t& next_id,
                                             RememberedStart* remembered) {
  return std::make_unique<BandSegmenter>(settings, next_id, remembered);
}

}  // namespace hapticast::server
