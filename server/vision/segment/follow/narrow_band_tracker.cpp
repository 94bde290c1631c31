// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/narrow_band_tracker.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/rules.hpp"

namespace hapticast::server {

namespace {

// Chosen, frames from a failed automatic choice to the next one. An attempt with proposals costs as
// much as 30 frames, one without as much as one.
constexpr int kChooseEvery = 3;
constexpr int kChooseAgain = 60;
// Chosen, frames of loss until another object replaces an automatic choice.
constexpr int kForgetAfter = 15;
constexpr int kNewPlanesAfter = 5;  // chosen, frames: RANSAC costs more than a frame
constexpr int kFollowBox = 50;   // chosen, frames: a filter that has drifted longer finds nothing
constexpr int kLightEvery = 30;  // chosen, frames: light changes slowly
// Chosen: overlap with a present object that makes both the same.
constexpr double kSameObject = 0.5;
constexpr double kPlaneIsObject = 0.3;  // chosen: share of an object's pixels on a new plane

}  // namespace

NarrowBandTracker::NarrowBandTracker(const VisionSettings& settings, std::uint32_t& next_id,
                                     ClipAnnotations* annotations)
    : annotation_track_(settings),
      explain_(settings.explain),
      named_(static_cast<int>(settings.objects.size())),
      next_id_(next_id),
      annotations_(annotations) {
  if (annotations_ != nullptr) scene_.avoided = annotations_->avoided;
}

std::vector<Segment> NarrowBandTracker::next(const FramePair& frames, const Flows& flows) {
  if (frames.cut) forgetScene();
  if (frame_ > 0 || !findAgain(frames.now)) decide(frames, flows);
  if (const auto* masks = findPropagatedMasks(frames)) {
    adoptTaught(frames.now, *masks);
    shareOut();
  } else if (const Annotation annotation = annotation_track_.findAnnotation(frames);
             !annotation.empty()) {
    applyAnnotation(annotation, frames);
    shareOut();
  }
  keepHistory(frames);
  ++frame_;
  std::vector<Segment> out;
  for (const TrackedMask& object : objects_) {
    if (object.present())
      out.push_back({object.id(), object.mask(), object.quality(), object.number()});
  }
  return out;
}

void NarrowBandTracker::forgetScene() {
  new_scene_ = true;
  next_choice_ = 0;
  past_.clear();
  doubts_.clear();
  if (annotation_track_.atStart().on.empty()) objects_.clear();
  for (TrackedMask& object : objects_) object.lose();
}

void NarrowBandTracker::decide(const FramePair& frames, const Flows& flows) {
  scene_.noise = frames.noise;
  updatePlanes(frames.now);
  if (frame_ % kLightEvery == 0) scene_.skin = SkinColors::adaptToLight(frames.now.color);
  updateObjects(frames, flows);
  if (frame_ == 0) startAtPoints(frames.now);
  if (choosesByItself(frames)) chooseByItself(frames.now);
  shareOut();
  if (frame_ == 0) remember(frames.now);
}

void NarrowBandTracker::updateObjects(const FramePair& frames, const Flows& flows) {
  const FrameImages& images = frames.now;
  for (TrackedMask& object : objects_) {
    const std::optional<cv::Rect> box = followBox(object, frames);
    if (!object.present()) {
      if (auto again = object.search(images, scene_, box); again && !isAnother(*again)) {
        again->rename(next_id_++);
        object = std::move(*again);
      }
      continue;
    }
    const auto flow = flows.find(object.id());
    if (flow != flows.end() && flow->second.isStatic) continue;
    const ObjectFlow moved = flow != flows.end() ? flow->second : ObjectFlow{};
    object.update(images, moved, scene_, box);
  }
}

// Returns the box of an object whose mask is in doubt, from its last sure frame on.
std::optional<cv::Rect> NarrowBandTracker::followBox(const TrackedMask& object,
                                                     const FramePair& frames) {
  Doubt& doubt = doubts_[object.number()];
  if (object.present() && object.isDecided()) {
    doubt = {frames.last.color, {}, 0};
    return std::nullopt;
  }
  if (doubt.sure_color.empty() || !usesRule(Rule::kBox)) return std::nullopt;
  if (++doubt.frames > kFollowBox || object.isPlaceRefuted()) {
    doubt = {};
    return std::nullopt;
  }
  if (!doubt.box) doubt.box.emplace(doubt.sure_color, findBoxAround(object.lastSure(), 0));
  return doubt.box->next(frames.now.color);
}

void NarrowBandTracker::remember(const FrameImages& images) {
  if (annotations_ == nullptr) return;
  annotations_->start =
      std::make_shared<InitialState>(InitialState{images.color, images.depth, objects_, scene_});
  annotations_->avoided = scene_.avoided;
}

// An equal first frame has an equal initial state, except for the ids.
bool NarrowBandTracker::findAgain(const FrameImages& images) {
  if (annotations_ == nullptr || annotations_->start == nullptr) return false;
  const InitialState& start = *annotations_->start;
  if (!equalImages(start.color, images.color) || !equalImages(start.depth, images.depth))
    return false;
  objects_ = start.objects;
  for (TrackedMask& object : objects_) object.rename(next_id_++);
  scene_ = start.scene;
  new_scene_ = false;
  return true;
}

void NarrowBandTracker::updatePlanes(const FrameImages& images) {
  if (!new_scene_ && refitPlanes(images.depth, scene_.planes)) return;
  if (!new_scene_ && frame_ - planes_frame_ < kNewPlanesAfter) return;
  new_scene_ = false;
  cv::Mat background = images.depth;
  for (const TrackedMask& object : objects_) {
    if (!object.present()) continue;
    if (background.data == images.depth.data) background = images.depth.clone();
    background.setTo(0, object.mask());  // an object's front is no supporting plane
  }
  scene_.planes = findPlanes(background, scene_.noise);
  for (const TrackedMask& object : objects_) removePlanes(object, images);
  planes_frame_ = frame_;
}

// A new plane may be the object itself; it is removed. Marks the planes that support the object.
void NarrowBandTracker::removePlanes(const TrackedMask& object, const FrameImages& images) {
  if (!object.present()) return;
  const double area = cv::countNonZero(object.mask() & (images.depth > 0));
  const cv::Rect whole({0, 0}, images.depth.size());
  std::erase_if(scene_.planes, [&](Plane plane) {
    plane.support = false;
    return cv::countNonZero(findOnPlanes(images.depth, whole, {plane}) & object.mask()) >
           kPlaneIsObject * area;
  });
  findSupports(images.depth, object.mask(), scene_.planes);
}

void NarrowBandTracker::startAtPoints(const FrameImages& images) {
  const Annotation& annotation = annotation_track_.atStart();
  for (const cv::Point& point : annotation.off)
    addNegativeSample(scene_.view(images), point, scene_.avoided);
  for (const ObjectPoint& point : annotation.on) {
    if (TrackedMask* known = findNumbered(objects_, point.number)) {
      if (known->mask().at<unsigned char>(point.at_px) == 0)
        known->correct(images, scene_, {{point}, annotation.off, {}});
      continue;
    }
    ChosenStart start = selectInitialMask(images, scene_, point.at_px, annotation.off);
    logChoice(start);
    if (!start.object) throwNoObject({double(point.at_px.x), double(point.at_px.y)}, start.why_not);
    if (point.candidate > 1) pickCandidate(start, point);
    start.object->addAnchor(point.at_px);
    addStart(std::move(start), point.number, images);
  }
}

void NarrowBandTracker::pickCandidate(ChosenStart& start, const ObjectPoint& point) {
  const auto count = static_cast<int>(start.ranked.size());
  if (point.candidate > count)
    spdlog::warn("--object {},{}#{}: there are only {} candidates; the server uses the last one",
                 point.at_px.x, point.at_px.y, point.candidate, count);
  start.object = start.ranked[static_cast<std::size_t>(std::min(point.candidate, count)) - 1];
}

void NarrowBandTracker::logChoice(const ChosenStart& start) const {
  if (!explain_) return;
  for (const std::string& line : start.explanation) spdlog::info("first mask: {}", line);
}

bool NarrowBandTracker::choosesByItself(const FramePair& frames) const {
  return annotation_track_.atStart().on.empty() && !annotation_track_.pointsLater() &&
         !frames.has_key_masks;
}

void NarrowBandTracker::chooseByItself(const FrameImages& images) {
  const bool given_up = !objects_.empty() && objects_[0].framesLost() > kForgetAfter;
  if ((!objects_.empty() && !given_up) || frame_ < next_choice_) return;
  ChosenStart start = selectAutomatically(images, scene_, annotation_track_.atStart().off);
  logChoice(start);
  if (!start.object) {
    next_choice_ = frame_ + (start.explanation.empty() ? kChooseEvery : kChooseAgain);
    return;
  }
  objects_.clear();
  addStart(std::move(start), 1, images);
}

void NarrowBandTracker::addStart(ChosenStart start, int number, const FrameImages& images) {
  scene_.planes = std::move(start.planes);
  start.object->rememberAppearance(images, scene_);
  add(std::move(*start.object), number);
}

void NarrowBandTracker::add(TrackedMask object, int number) {
  if (isAnother(object)) return;  // two points on one body mark one object
  object.rename(next_id_++);
  object.setNumber(number);
  objects_.push_back(std::move(object));
}

bool NarrowBandTracker::isAnother(const TrackedMask& found) const {
  return std::any_of(objects_.begin(), objects_.end(), [&](const TrackedMask& other) {
    return other.present() && found.overlapShare(other) > kSameObject;
  });
}

// No pixel belongs to two objects: the first object owns a shared pixel.
void NarrowBandTracker::shareOut() {
  for (std::size_t later = 1; later < objects_.size(); ++later) {
    for (std::size_t first = 0; first < later; ++first) {
      if (objects_[later].present() && objects_[first].present())
        objects_[later].yieldTo(objects_[first]);
    }
  }
}

}  // namespace hapticast::server
