// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/tracked_mask.hpp"

#include <algorithm>
#include <cmath>

#include "server/vision/segment/annotate/refine_clicks.hpp"
#include "server/vision/segment/follow/redetect.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr double kSettled = 0.004;  // of the area: a smaller change counts as rest
constexpr int kWeakFrames = 5;      // chosen, in a row: then the object is lost
constexpr int kSearchEvery = 3;     // chosen: a search costs as much as a frame
// Chosen, of the whole: with less visible the model does not change.
constexpr double kMostlySeen = 0.6;
// Chosen, of the area in a frame: outside of these two limits the.
constexpr double kLeastGrowth = 0.8;
constexpr double kMostGrowth = 1.25;  // decision is rejected
constexpr double kWeaker = 0.7;       // chosen: quality of a frame without a sure measurement
constexpr double kOwnColors = 0.5;    // mean colour evidence of certain pixels of the object
constexpr double kSurelyColor = 0.8;  // mean colour evidence of pixels that may be uncovered again
constexpr double kUsualFollows = 0.01;  // chosen: the usual size adapts in four seconds
constexpr int kLookEvery = 15;  // chosen, frames: a re-detection costs as much as two frames
constexpr double kClearlyBetter = 0.12;
constexpr double kAsUsual = 0.1;  // chosen, ln of an area: largest loss
constexpr int kAgainRounds = 3;
constexpr double kNearest = 0.6;  // chosen, of its last depth: range of the search
constexpr double kFarthest = 1.6;
constexpr double kLessLike = 0.8;         // of its initial score: limit for a found object ...
constexpr double kMostUnlike = 1.2;       // ... and limit for the tracked object
constexpr double kMostAgain = 1.6;        // of its usual area
constexpr double kSurelyLikeSkin = 0.05;  // limit in an author's key mask, which has no hand
// Measured: after a correction the rest had 0.55 to 0.59 of the object's colours if it was another
// object, else 0.71 or more.
constexpr double kOfOtherColors = 0.65;
constexpr double kLikeSkin = 0.2;  // chosen, of its pixels: then colour cannot separate hands

// Returns the colours of the picture without the object, of every second pixel and row.
ColorHistogram elsewhere(const FrameImages& images, const cv::Mat& mask) {
  ColorHistogram out;
  for (int v = 0; v < mask.rows; v += 2) {
    const auto* color = images.color.ptr<cv::Vec3b>(v);
    const auto* in = mask.ptr<unsigned char>(v);
    for (int u = 0; u < mask.cols; u += 2) {
      if (in[u] == 0) out.count(color[u]);
    }
  }
  out.finish();
  return out;
}

double meanEvidence(const ContourMemory& memory, const cv::Mat& color, const cv::Mat& where) {
  const std::vector<float> evidence = computeColorEvidence(memory);
  double sum = 0.0;
  double count = 0.0;
  for (int v = 0; v < where.rows; v += 2) {
    const auto* row = color.ptr<cv::Vec3b>(v);
    const auto* in = where.ptr<unsigned char>(v);
    for (int u = 0; u < where.cols; u += 2) {
      if (in[u] == 0) continue;
      sum += double(evidence[ColorHistogram::binIndex(row[u])]);
      count += 1.0;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

}  // namespace

TrackedMask::TrackedMask(std::uint32_t id, const cv::Mat& first_mask, const FrameImages& images,
                         const SceneContext& scene, int most_rounds)
    : id_(id), mask_(first_mask), whole_(first_mask) {
  relax(images, scene, most_rounds);
}

void TrackedMask::forgetColors(const SceneContext& scene) {
  memory_ = {};
  memory_.avoided = scene.avoided.histogram;
}

void TrackedMask::relax(const FrameImages& images, const SceneContext& scene, int most_rounds) {
  for (int round = 0; round < most_rounds; ++round) {
    const ObjectRoi patch = patchAround(images, mask_);
    if (patch.empty()) return;
    forgetColors(scene);
    updateMemory(patch, mask_(patch.box), memory_);
    const cv::Mat mask = decideContour(patch, scene.noise, scene.planes, memory_).mask;
    const int changed = cv::countNonZero(mask != mask_(patch.box));
    const int area = cv::countNonZero(mask);
    if (area < kSmallestObject_px) break;
    mask_ = wholePicture(mask, patch, images);
    if (changed < kSettled * area) break;
  }
  learnAppearance(patchAround(images, mask_), images, scene, kLikeSkin);
}

void TrackedMask::learnAppearance(const ObjectRoi& patch, const FrameImages& images,
                                  const SceneContext& scene, double most_skin) {
  forgetColors(scene);
  updateMemory(patch, mask_(patch.box), memory_);
  memory_.elsewhere = elsewhere(images, mask_);
  const cv::Mat skin = scene.skin.in(patch.color) & patch.inside;
  like_skin_ = cv::countNonZero(skin) > most_skin * cv::countNonZero(patch.inside);
  whole_ = mask_;
  isSeenWell(patch);
}

void TrackedMask::isSeenWell(const ObjectRoi& patch) {
  const double area = cv::countNonZero(whole_(patch.box));
  // An object that leaves the picture has not shrunk.
  if (clearOfBorder(whole_) || area > area_px_) area_px_ = area;
  if (const auto depth = depthSpan(patch, patch.inside)) depth_ = *depth;
  usual_px_ = usual_px_ > 0 ? usual_px_ + kUsualFollows * (area - usual_px_) : area;
  quality_ = 1.0;
  weak_ = 0;
}

ObjectLimits TrackedMask::limits(const SceneContext& scene) const {
  return {depth_.nearest_mm(scene.noise), depth_.farthest_mm(scene.noise),
          like_skin_ ? nullptr : &scene.skin, own_.empty() ? nullptr : &own_};
}

// Returns whether the decision is plausible.
bool TrackedMask::convinces(const ContourResult& now, double expected_px) const {
  const double area = cv::countNonZero(now.mask);
  const double growth = area / expected_px;
  if (growth > kMostGrowth)  // uncovered again
    return now.inside_color >= kSurelyColor && area < kMostGrowth * usual_px_;
  return growth >= kLeastGrowth && now.inside_color >= 0.0;
}

// Returns the patch at the expected position. If most of the object seems hidden or farther, but
// has its own colours, the depth jumped; then the limits do not apply.
ObjectRoi TrackedMask::expected(const FrameImages& images, const cv::Matx23d& similarity,
                                const SceneContext& scene) const {
  ObjectLimits within = limits(scene);
  ObjectRoi patch = patchAround(images, whole_, similarity, within);
  if (patch.empty() || patch.hidden.empty()) return patch;
  const int hidden = cv::countNonZero(patch.hidden);
  if (hidden <= cv::countNonZero(patch.inside)) return patch;
  if (meanEvidence(memory_, patch.color, patch.hidden) < kOwnColors) return patch;
  within.nearest_mm = within.farthest_mm = 0.0;
  return patchAround(images, whole_, similarity, within);
}

void TrackedMask::update(const FrameImages& images, const ObjectFlow& flow,
                         const SceneContext& scene) {
  cv::Matx23d similarity = flow.similarity;
  ObjectRoi patch = expected(images, similarity, scene);
  // A motion that leads to other colours was not the object's.
  if (patch.empty() || meanEvidence(memory_, patch.color, patch.inside) < 0.0) {
    const ObjectRoi still = expected(images, ObjectFlow{}.similarity, scene);
    if (!still.empty() && meanEvidence(memory_, still.color, still.inside) > kOwnColors) {
      patch = still;
      similarity = ObjectFlow{}.similarity;
    }
  }
  if (patch.empty()) return lose();
  warpEvidence(memory_, patch, similarity);
  const ContourResult now = decideContour(patch, scene.noise, scene.planes, memory_);
  const double expected_px = cv::countNonZero(patch.inside) * patch.factor * patch.factor;
  const bool nothing =
      cv::countNonZero(now.mask) < kSmallestObject_px || expected_px < kSmallestObject_px;
  const bool convincing = !nothing && convinces(now, expected_px);
  setMask(convincing ? now.mask : atFullSize(patch.inside, patch), patch, images);
  if (convincing) {
    isSeenWell(patch);
    if (!flow.reliable) quality_ = kWeaker;
    if (expected_px > kMostlySeen * area_px_) updateMemory(patch, now.mask, memory_);
  } else {
    quality_ *= kWeaker;
    ++weak_;
  }
  const bool is_uncertain = weak_ == 2 || weak_ > kWeakFrames;
  if ((is_uncertain || ++since_search_ >= kLookEvery) && redetectObject(images, scene)) return;
  const bool leaving = weak_ > 0 && !clearOfBorder(mask_);
  if (nothing || weak_ > kWeakFrames || leaving) lose();
}

// Sets the mask to `seen`, which covers the patch's box; adds the hidden part to the whole.
void TrackedMask::setMask(const cv::Mat& seen, const ObjectRoi& patch, const FrameImages& images) {
  mask_ = wholePicture(seen, patch, images);
  const bool hidden = !patch.hidden.empty() && cv::countNonZero(patch.hidden) > 0;
  whole_ = hidden ? wholePicture(seen | atFullSize(patch.hidden, patch), patch, images) : mask_;
}

// Searches for the object by one graph cut. Returns true if that decides: the result is better than
// the propagated mask, or neither resembles the object.
bool TrackedMask::redetectObject(const FrameImages& images, const SceneContext& scene) {
  since_search_ = 0;
  const KnownObject known{memory_, limits(scene), usual_px_, mask_};
  const FrameContext view = scene.view(images);
  const cv::Mat mask = redetect(view, known);
  if (mask.empty() || cv::countNonZero(mask) < kSmallestObject_px) return false;
  const double now = reidentificationScore(view, known, mask_);
  const double then = reidentificationScore(view, known, mask);
  if (std::max(now, then) < likeness_ - kMostUnlike) lose();
  const auto unusual = [this](const cv::Mat& m) {
    return std::abs(std::log(std::max(1, cv::countNonZero(m)) / usual_px_));
  };
  const bool better = then >= now + kClearlyBetter && unusual(mask) <= unusual(mask_) + kAsUsual;
  if (!present() || !better) return !present();
  mask_ = mask;
  whole_ = mask;
  memory_.evidence.release();
  isSeenWell(patchAround(images, mask_));
  return true;
}

void TrackedMask::rememberAppearance(const FrameImages& images, const SceneContext& scene) {
  likeness_ = likeness(images, scene, mask_);
}

double TrackedMask::likeness(const FrameImages& images, const SceneContext& scene,
                             const cv::Mat& mask) const {
  const KnownObject known{memory_, limits(scene), usual_px_, mask};
  return reidentificationScore(scene.view(images), known, mask);
}

void TrackedMask::correct(const FrameImages& images, const SceneContext& scene,
                          const Annotation& annotation) {
  memory_.avoided = scene.avoided.histogram;
  const cv::Mat mask = refineWithClicks(scene.view(images), mask_, annotation);
  if (cv::countNonZero(mask) < kSmallestObject_px) return lose();
  // The rest of another object, without the part at the point, is not the object either.
  if (annotation.on.empty() &&
      computeOverlap(ColorHistogram::fromImage(images.color, mask), memory_.first) < kOfOtherColors)
    return lose();
  adopt(mask, images, scene, false);
}

void TrackedMask::adopt(const cv::Mat& mask, const FrameImages& images, const SceneContext& scene,
                        bool given) {
  const ObjectRoi patch = patchAround(images, mask);
  if (patch.empty()) return;
  const cv::Mat added = mask & ~mask_;
  if (present() && cv::countNonZero(added) >= kSmallestObject_px)
    own_.raise(ColorHistogram::fromImage(images.color, added), 1.0);
  mask_ = mask;
  lost_ = 0;
  since_search_ = 0;
  learnAppearance(patch, images, scene, given ? kSurelyLikeSkin : kLikeSkin);
  rememberAppearance(images, scene);
}

void TrackedMask::yieldTo(const TrackedMask& other) {
  // Needs a new image: the whole and perhaps a stored initial state share the old one.
  cv::Mat rest;
  cv::bitwise_and(mask_, ~other.mask_, rest);
  mask_ = rest;
  if (cv::countNonZero(mask_) < kSmallestObject_px) lose();
}

double TrackedMask::overlapShare(const TrackedMask& other) const {
  return double(cv::countNonZero(mask_ & other.mask_)) / std::max(1, cv::countNonZero(mask_));
}

void TrackedMask::lose() {
  lost_ = 1;
  quality_ = 0.0;
}

std::optional<TrackedMask> TrackedMask::search(const FrameImages& images,
                                               const SceneContext& scene) {
  if (lost_++ % kSearchEvery != 0) return std::nullopt;
  const ObjectLimits anywhere{kNearest * depth_.middle_mm, kFarthest * depth_.middle_mm,
                              like_skin_ ? nullptr : &scene.skin};
  const KnownObject known{memory_, anywhere, usual_px_, {}};
  const FrameContext view = scene.view(images);
  const cv::Mat found = redetect(view, known);
  if (found.empty() || cv::countNonZero(found) < kSmallestObject_px) return std::nullopt;
  TrackedMask again = *this;
  again.mask_ = again.whole_ = found;
  for (int round = 0; round < kAgainRounds; ++round) {
    const ObjectRoi patch = patchAround(images, again.mask_);
    if (patch.empty()) return std::nullopt;
    again.memory_.evidence.release();  // belongs to another patch
    const ContourResult now = decideContour(patch, scene.noise, scene.planes, again.memory_);
    if (cv::countNonZero(now.mask) < kSmallestObject_px) return std::nullopt;
    again.mask_ = wholePicture(now.mask, patch, images);
  }
  const double like = reidentificationScore(view, known, again.mask_);
  if (like < likeness_ - kLessLike || cv::countNonZero(again.mask_) > kMostAgain * usual_px_)
    return std::nullopt;
  again.whole_ = again.mask_;
  again.lost_ = 0;
  again.isSeenWell(patchAround(images, again.mask_));
  // The found mask may be a part of the object.
  again.area_px_ = std::max(again.area_px_, area_px_);
  again.usual_px_ = usual_px_;
  return again;
}

}  // namespace hapticast::server
