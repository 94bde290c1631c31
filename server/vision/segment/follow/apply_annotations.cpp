// SPDX-License-Identifier: MIT
// Annotations of later frames: part of NarrowBandTracker. Applies points and key masks, and
// propagates the corrected masks backward to earlier frames.
#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/follow/narrow_band_tracker.hpp"

namespace hapticast::server {

namespace {

// Chosen, IoU: above it the tracked mask remains, so that it can rest.
constexpr double kAsTaught = 0.97;
constexpr double kAnother = 0.05;               // chosen, IoU: below it a mask shows another object
constexpr double kLargeCorrection = 1.0 / 3.0;  // of the mask: a larger correction is logged
// Measured, of the score: 0 leaves the errors before a correction, no limit hurts good masks.
constexpr double kClearlyLikelier = 0.3;
constexpr double kAlikeColors = 0.5;  // chosen, overlap of two histograms
constexpr double kNear = 2.0;  // chosen, in object widths: reach of a point that marks the object
constexpr std::size_t kPast_bytes = std::size_t{768} << 20U;  // chosen: 10 s of 640x480

cv::Mat placeInPicture(const PropagatedMask& propagated, const cv::Size& size) {
  cv::Mat out = cv::Mat::zeros(size, CV_8UC1);
  propagated.mask.copyTo(out(propagated.box));
  return out;
}

PropagatedMask toPropagatedMask(const TrackedMask& object, bool given) {
  const cv::Rect box = findBoxAround(object.mask(), 0);
  return {object.number(), box, object.mask()(box).clone(), given};
}

std::size_t countBytes(const FrameImages& images) {
  return images.color.total() * images.color.elemSize() + images.gray.total() +
         images.depth.total() * images.depth.elemSize();
}

// Returns whether the point lies on the rim of a mask. Such a point means a sliver of background,
// whose colours may also be the object's.
bool isOnRim(const std::vector<TrackedMask>& objects, const cv::Point& point) {
  return std::any_of(objects.begin(), objects.end(), [&](const TrackedMask& object) {
    if (!object.present() || !contains(object.mask(), point)) return false;
    const cv::Rect around =
        cv::Rect(point.x - kPoint_px, point.y - kPoint_px, 2 * kPoint_px + 1, 2 * kPoint_px + 1) &
        cv::Rect({0, 0}, object.mask().size());
    return cv::countNonZero(object.mask()(around)) < around.area();
  });
}

// Returns whether the colours of a negative point resemble those at a point of the author on an
// object. Then the negative point means its region only.
bool resemblesAnchor(const FrameContext& scene, const std::vector<TrackedMask>& objects,
                     const NegativeColors& sample) {
  return std::any_of(objects.begin(), objects.end(), [&](const TrackedMask& object) {
    const std::vector<cv::Point> anchors = object.visibleAnchors();
    return std::any_of(anchors.begin(), anchors.end(), [&](const cv::Point& anchor) {
      return computeOverlap(sampleColors(scene, anchor).histogram, sample.histogram) > kAlikeColors;
    });
  });
}

// Returns the distance from `point` to the nearest pixel of `mask`, in widths of the mask.
double measureWidthsOff(const cv::Mat& mask, const cv::Point& point) {
  cv::Mat pixels;
  cv::findNonZero(mask, pixels);
  double nearest = 1e18;
  for (int i = 0; i < int(pixels.total()); ++i) {
    const cv::Point off = pixels.at<cv::Point>(i) - point;
    nearest = std::min(nearest, double(off.dot(off)));
  }
  return std::sqrt(nearest / std::max(1.0, double(pixels.total())));
}

}  // namespace

bool NarrowBandTracker::hasAnnotation(const FramePair& frames) const {
  const auto* masks = findPropagatedMasks(frames);
  if (masks == nullptr) return !annotation_track_.findAnnotation(frames).empty();
  return std::any_of(masks->begin(), masks->end(), [&](const PropagatedMask& mask) {
    const TrackedMask* object = findNumbered(objects_, mask.number);
    if (object == nullptr || !object->present()) return !mask.box.empty();
    return mask.given || mask.box.empty() ||
           computeOverlap(object->mask(), placeInPicture(mask, frames.now.color.size())) <
               kAsTaught;
  });
}

const std::vector<PropagatedMask>* NarrowBandTracker::findPropagatedMasks(
    const FramePair& frames) const {
  if (annotations_ == nullptr) return nullptr;
  const auto found = annotations_->masks.find(frames.index);
  return found != annotations_->masks.end() ? &found->second : nullptr;
}

void NarrowBandTracker::adoptTaught(const FrameImages& images,
                                    const std::vector<PropagatedMask>& masks) {
  for (const PropagatedMask& propagated : masks) {
    if (propagated.box.empty()) {
      TrackedMask* hidden = findNumbered(objects_, propagated.number);
      if (hidden != nullptr && hidden->present()) hidden->lose();
      continue;
    }
    const cv::Mat mask = placeInPicture(propagated, images.color.size());
    const TrackedMask* object = findNumbered(objects_, propagated.number);
    const bool as_propagated = object != nullptr && object->present() && !propagated.given &&
                               computeOverlap(object->mask(), mask) >= kAsTaught;
    if (!as_propagated) place(propagated.number, mask, images);
  }
}

// Sets the mask of the object with this number; the object may be lost or not exist yet.
void NarrowBandTracker::place(int number, const cv::Mat& mask, const FrameImages& images) {
  TrackedMask* object = findNumbered(objects_, number);
  if (object == nullptr) {
    object = &objects_.emplace_back(next_id_++, mask, images, scene_, 0);
    object->setNumber(number);
  } else if (!object->present()) {
    object->rename(next_id_++);
  }
  object->adopt(mask, images, scene_);
}

void NarrowBandTracker::applyAnnotation(const Annotation& annotation, const FramePair& frames) {
  const FrameImages& images = frames.now;
  for (const cv::Point& point : annotation.off) {
    if (isOnRim(objects_, point)) continue;
    const NegativeColors sample = sampleColors(scene_.view(images), point);
    if (!resemblesAnchor(scene_.view(images), objects_, sample)) addSample(sample, scene_.avoided);
  }
  if (annotations_ != nullptr && annotations_->open) annotations_->avoided = scene_.avoided;
  for (TrackedMask& object : objects_) {
    const auto in_it = [&](const cv::Point& p) { return contains(object.mask(), p); };
    const auto is_on = [&](const ObjectPoint& p) { return in_it(p.at_px); };
    if (!object.present() || std::none_of(annotation.off.begin(), annotation.off.end(), in_it))
      continue;
    Annotation of_it{{}, annotation.off, {}};
    std::copy_if(annotation.on.begin(), annotation.on.end(), std::back_inserter(of_it.on), is_on);
    correct(object, of_it, frames);
  }
  for (const ObjectPoint& point : annotation.on) applyPoint(point, annotation, frames);
  if (annotation.masks.empty()) return;
  double numbers = 0.0;
  cv::minMaxLoc(annotation.masks, nullptr, &numbers);
  for (int number = 1; number <= int(numbers); ++number) {
    const cv::Mat mask = annotation.masks == double(number);
    if (cv::countNonZero(mask) < kSmallestObject_px) continue;
    const TrackedMask* known = findNumbered(objects_, number);
    if (known != nullptr && known->present() && computeOverlap(known->mask(), mask) < kAnother)
      spdlog::warn("the mask drawn for frame {} does not match object {}; the server uses the mask",
                   frames.index, number);
    place(number, mask, images);
    propagate(*findNumbered(objects_, number), frames, true);
  }
}

// Returns the object that a point outside all objects marks: an object nearby, else a lost object.
TrackedMask* NarrowBandTracker::findObjectAt(const cv::Point& point) {
  TrackedMask* lost = nullptr;
  for (TrackedMask& object : objects_) {
    if (object.present() && measureWidthsOff(object.mask(), point) < kNear) return &object;
    if (!object.present() && lost == nullptr) lost = &object;
  }
  return lost;
}

void NarrowBandTracker::applyPoint(const ObjectPoint& point, const Annotation& annotation,
                                   const FramePair& frames) {
  const auto holds = [&](const TrackedMask& o) {
    return o.present() && contains(o.mask(), point.at_px);
  };
  if (std::any_of(objects_.begin(), objects_.end(), holds)) return;
  const FrameImages& images = frames.now;
  TrackedMask* object =
      point.number != 0 ? findNumbered(objects_, point.number) : findObjectAt(point.at_px);
  if (object != nullptr && object->present()) {
    correct(*object, {{point}, annotation.off, {}}, frames);
    return;
  }
  ChosenStart start = selectInitialMask(images, scene_, point.at_px, annotation.off);
  logChoice(start);
  if (!start.object) {
    spdlog::warn("--object {:.0f},{:.0f}@{:.2f}: {}; it is left out",
                 point.at_px.x * frames.own_px.x(), point.at_px.y * frames.own_px.y(),
                 frames.clip_time_s, start.why_not);
    return;
  }
  int number = point.number != 0 ? point.number : named_ + 1;
  if (object != nullptr) number = object->number();
  while (object == nullptr && findNumbered(objects_, number) != nullptr) ++number;
  place(number, start.object->mask(), images);
  findNumbered(objects_, number)->addAnchor(point.at_px);
  propagate(*findNumbered(objects_, number), frames, false);
}

void NarrowBandTracker::correct(TrackedMask& object, const Annotation& annotation,
                                const FramePair& frames) {
  const cv::Mat before = object.mask();
  object.correct(frames.now, scene_, annotation);
  const cv::Mat now =
      object.present() ? object.mask() : cv::Mat(cv::Mat::zeros(before.size(), CV_8UC1));
  const double changed = double(cv::countNonZero(before != now)) / cv::countNonZero(before);
  if (changed > kLargeCorrection)
    spdlog::info("the points at {:.2f} s change {:.0f} % of the mask of object {}{}",
                 frames.clip_time_s, 100.0 * changed, object.number(),
                 object.present() ? "" : "; nothing of the object remains, so it is lost there");
  propagate(object, frames, false);
}

// Stores earlier frames while later annotations may still change them.
void NarrowBandTracker::keepHistory(const FramePair& frames) {
  const bool more = frames.has_key_masks || annotation_track_.hasLaterAnnotation(frames);
  if (annotations_ == nullptr || !annotations_->open || !more) {
    past_.clear();
    return;
  }
  Past past{frames.index, frames.now, {}};
  for (const TrackedMask& object : objects_) {
    if (object.present()) past.masks[object.number()] = object.mask();
  }
  past_.push_back(std::move(past));
  while (past_.size() * countBytes(frames.now) > kPast_bytes) past_.pop_front();
}

void NarrowBandTracker::propagate(TrackedMask& object, const FramePair& frames, bool given) {
  if (annotations_ == nullptr || !annotations_->open) return;
  if (!object.present()) {
    annotations_->masks[frames.index].push_back({object.number(), {}, {}, given});
    last_annotation_[object.number()] = frames.index;
    return;
  }
  const auto last = last_annotation_.find(object.number());
  std::uint64_t until = 0;
  if (last != last_annotation_.end()) until = (last->second + frames.index) / 2 + 1;
  last_annotation_[object.number()] = frames.index;
  annotations_->masks[frames.index].push_back(toPropagatedMask(object, given));
  propagateBackwards(object, frames, until, given);
}

// The corrected mask counts more than the mask that was followed forwards, unless that one clearly
// resembles the object more. Masks without a decision in their frame are not stored: the object may
// be hidden there.
void NarrowBandTracker::propagateBackwards(TrackedMask object, const FramePair& frames,
                                           std::uint64_t until, bool given) {
  SceneContext scene = scene_;
  const FrameImages* later = &frames.now;
  std::vector<std::pair<std::uint64_t, PropagatedMask>> carried;
  for (auto past = past_.rbegin(); past != past_.rend() && past->index >= until; ++past) {
    if (past->index >= frames.index) continue;
    const ObjectFlow flow = trackObject(later->gray, past->images.gray, object.mask(), {0, 0});
    if (!refitPlanes(past->images.depth, scene.planes)) scene.planes.clear();
    object.update(past->images, flow, scene);
    if (!object.present()) return;
    later = &past->images;
    const auto before = past->masks.find(object.number());
    if (before != past->masks.end()) {
      if (computeOverlap(before->second, object.mask()) >= kAsTaught)
        return;  // the masks are equal from here on
      const double now = object.computeLikeness(past->images, scene, object.mask());
      if (!given &&
          object.computeLikeness(past->images, scene, before->second) > now + kClearlyLikelier)
        continue;
    }
    carried.emplace_back(past->index, toPropagatedMask(object, false));
    if (!object.isDecided()) continue;
    for (auto& [index, mask] : carried) annotations_->masks[index].push_back(std::move(mask));
    carried.clear();
  }
}

}  // namespace hapticast::server
