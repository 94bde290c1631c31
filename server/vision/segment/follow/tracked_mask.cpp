// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/tracked_mask.hpp"

#include <algorithm>
#include <cmath>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/follow/redetect.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/initialise/refine_clicks.hpp"
#include "server/vision/segment/rules.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr double kSettled = 0.004;  // of the area: a smaller change counts as rest
constexpr int kWeakFrames = 5;      // chosen, in a row: then the object is lost
// Chosen, of the whole: with less visible the model does not change.
constexpr double kMostlySeen = 0.6;
constexpr double kMostlyWhole = 0.85;  // chosen, of its usual area: a smaller mask may be a part
constexpr double kLeastSeen = 0.08;    // chosen, of its area: with less visible it is hidden
// Chosen, of the area in a frame: outside of these two limits the decision is rejected.
constexpr double kLeastGrowth = 0.8;
constexpr double kMostGrowth = 1.25;
constexpr double kWeaker = 0.7;         // chosen: quality of a frame without a sure measurement
constexpr double kOwnColors = 0.5;      // mean colour evidence of certain pixels of the object
constexpr double kPartlyHidden = 0.15;  // chosen, of the whole: less is noise of the depth
constexpr double kSizeJump = 0.05;      // chosen, of the size in a frame: faster growth is an error
constexpr double kPlaceJump = 0.2;      // chosen, of the width: likewise a change of motion
constexpr double kDistinct = 0.65;      // chosen: overlap of the colours of object and background
constexpr int kDetachedFrames = 3;      // chosen: a piece beside a finger that passes stays
constexpr double kClearlyUnlike = 0.15;  // chosen, overlap of colours
constexpr double kDistinctHand = 0.5;    // chosen, overlap of the colours of hand and object
constexpr double kTouchingShare = 0.1;   // chosen, of the ring: a hand that holds covers more
constexpr int kLeastHand_px = 40;        // chosen: fewer pixels are no sample of colours
constexpr double kNotTheRoom = 0.5;      // chosen, overlap: a hand covers a small part of the room
constexpr double kStill_px = 0.5;        // chosen, in a frame
constexpr double kClearlyOwn = 0.4;      // more of that evidence: another position is better
constexpr double kSurelyColor = 0.8;  // mean colour evidence of pixels that may be uncovered again
constexpr double kUsualFollows = 0.01;  // chosen: the usual size adapts in four seconds
// Measured: after a correction the rest had 0.55 to 0.59 of the object's colours if it was another
// object, else 0.71 or more.
constexpr double kOfOtherColors = 0.65;

// Returns the colours of the picture without the object, of every second pixel and row.
ColorHistogram collectElsewhere(const FrameImages& images, const cv::Mat& mask) {
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

bool isMostlySeen(const ObjectRoi& patch) {
  if (patch.hidden.empty()) return true;
  const double inside = cv::countNonZero(patch.inside);
  return inside >= kMostlySeen * (inside + cv::countNonZero(patch.hidden));
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
  ColorHistogram hand = memory_.hand;
  memory_ = {};
  memory_.avoided = scene.avoided.histogram;
  memory_.hand = hand;
}

void TrackedMask::relax(const FrameImages& images, const SceneContext& scene, int most_rounds) {
  for (int round = 0; round < most_rounds; ++round) {
    const ObjectRoi patch = makePatch(images, mask_);
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
  learnAppearance(makePatch(images, mask_), images, scene, true);
}

void TrackedMask::learnAppearance(const ObjectRoi& patch, const FrameImages& images,
                                  const SceneContext& scene, bool is_whole) {
  forgetColors(scene);
  updateMemory(patch, mask_(patch.box), memory_);
  updateShape(patch, mask_(patch.box), is_whole, memory_);
  if (usesRule(Rule::kElsewhere)) memory_.elsewhere = collectElsewhere(images, mask_);
  whole_ = mask_;
  resetToVisible(patch);
}

void TrackedMask::resetToVisible(const ObjectRoi& patch) {
  const double area = cv::countNonZero(whole_(patch.box));
  // An object that leaves the picture has not shrunk.
  if (clearOfBorder(whole_) || area > area_px_) area_px_ = area;
  if (const auto depth = depthSpan(patch, patch.inside)) depth_ = *depth;
  usual_px_ = usual_px_ > 0 ? usual_px_ + kUsualFollows * (area - usual_px_) : area;
  quality_ = 1.0;
  weak_ = 0;
  last_sure_ = whole_;
}

ObjectLimits TrackedMask::limits(const SceneContext& scene) const {
  // Where the background has the object's colours, colours show no hand either.
  const bool distinct = computeOverlap(memory_.first, memory_.background) < kDistinct;
  return {depth_.nearest_mm(scene.noise), depth_.farthest_mm(scene.noise),
          distinct ? &scene.skin : nullptr, computeColorEvidence(memory_)};
}

// Returns whether the decision is plausible.
bool TrackedMask::convinces(const ContourResult& now, double expected_px) const {
  const double area = cv::countNonZero(now.mask);
  const double growth = area / expected_px;
  if (growth > kMostGrowth)  // uncovered again
    return now.inside_color >= kSurelyColor && area < kMostGrowth * usual_px_;
  return growth >= kLeastGrowth && now.inside_color >= 0.0;
}

// Returns whether `similarity` changes the size too fast, or moves the object unlike the last
// frame.
bool TrackedMask::isJump(const cv::Matx23d& similarity) const {
  const ObjectFlow now{.similarity = similarity, .tracks = {}};
  if (std::abs(now.scale() - 1.0) > kSizeJump) return true;
  const cv::Rect box = findBoxAround(whole_, 0);
  const cv::Moments moments = cv::moments(whole_(box), true);
  const cv::Point2d middle = computeCentroid(moments, box.tl());
  const ObjectFlow last{.similarity = last_similarity_, .tracks = {}};
  return cv::norm(now.warp(middle) - last.warp(middle)) > kPlaceJump * std::sqrt(moments.m00);
}

// Returns the patch at the place to which `similarity` leads. Returns the patch at the old place or
// at `box`, and sets `similarity` to that motion, if the colours there are clearly more the
// object's. What passes in front of an object pushes its motion. A partly hidden object that seems
// to jump moves as in the last frame (dead reckoning).
ObjectRoi TrackedMask::locate(const FrameImages& images, const SceneContext& scene,
                              const std::optional<cv::Rect>& box, cv::Matx23d& similarity) const {
  const bool is_partly_hidden =
      cv::countNonZero(whole_ != mask_) > kPartlyHidden * cv::countNonZero(whole_);
  if (usesRule(Rule::kDeadReckoning) && is_partly_hidden && isJump(similarity))
    similarity = last_similarity_;
  const ObjectLimits within = limits(scene);
  ObjectRoi patch = makePatch(images, whole_, similarity, within);
  const double moved = patch.empty() ? -1.0 : meanEvidence(memory_, patch.color, patch.inside);
  if (moved >= 0.0 && !is_partly_hidden) return patch;
  std::vector<cv::Matx23d> others;
  if (usesRule(Rule::kRestingPlace)) others.push_back(ObjectFlow{}.similarity);
  if (box) {
    const cv::Rect last = findBoxAround(whole_, 0);
    others.push_back({1, 0, box->x - last.x + 0.5 * (box->width - last.width), 0, 1,
                      box->y - last.y + 0.5 * (box->height - last.height)});
  }
  double least = std::max(kOwnColors, moved + kClearlyOwn);
  for (const cv::Matx23d& other : others) {
    ObjectRoi there = makePatch(images, whole_, other, within);
    const double own = there.empty() ? -1.0 : meanEvidence(memory_, there.color, there.inside);
    if (own <= least) continue;
    least = own;
    similarity = other;
    patch = std::move(there);
  }
  return patch;
}

void TrackedMask::update(const FrameImages& images, const ObjectFlow& flow,
                         const SceneContext& scene, const std::optional<cv::Rect>& box) {
  cv::Matx23d similarity = flow.similarity;
  const ObjectRoi patch = locate(images, scene, box, similarity);
  if (patch.empty()) return lose();
  const bool is_mostly_seen = isMostlySeen(patch);
  // The motion of a mostly hidden object is not exact enough to move its shape.
  if (!is_mostly_seen) memory_.shape.release();
  // A way to the box lasted several frames: it is no motion of one frame.
  const bool is_flow = similarity == flow.similarity || similarity == last_similarity_;
  last_similarity_ = is_flow ? similarity : ObjectFlow{}.similarity;
  warpEvidence(memory_, patch, similarity);
  ContourResult now = decideContour(patch, scene.noise, scene.planes, memory_);
  // An object that is mostly hidden comes back where it was: it does not grow beyond its whole.
  if (!is_mostly_seen) now.mask &= scaleToFullSize(dilateBy(patch.inside | patch.hidden, 1), patch);
  const double expected_px = cv::countNonZero(patch.inside) * patch.factor * patch.factor;
  const bool nothing =
      cv::countNonZero(now.mask) < kSmallestObject_px || expected_px < kSmallestObject_px;
  const bool convincing = !nothing && convinces(now, expected_px);
  if (convincing && usesRule(Rule::kDetachedPieces)) dropDetachedPieces(patch, now.mask);
  setMask(convincing ? now.mask : scaleToFullSize(patch.inside, patch), patch, images);
  if (convincing) {
    resetToVisible(patch);
    if (!flow.reliable) quality_ = kWeaker;
    updateShape(patch, now.mask, cv::countNonZero(now.mask) > kMostlyWhole * usual_px_, memory_);
    if (expected_px > kMostlySeen * area_px_) updateMemory(patch, now.mask, memory_);
    if (memory_.hand.empty() && usesRule(Rule::kHandColors))
      learnTouchingHand(patch, now.mask, scene);
  } else {
    quality_ *= kWeaker;
    ++weak_;
    detached_ = 0;
  }
  moveAnchors(similarity);
  checkPresence(patch, similarity, nothing, images, scene);
}

// Marks the object as lost where the new mask is no longer plausible. `nothing`: almost no pixel of
// it is visible.
void TrackedMask::checkPresence(const ObjectRoi& patch, const cv::Matx23d& similarity, bool nothing,
                                const FrameImages& images, const SceneContext& scene) {
  const bool is_uncertain = weak_ == 2 || weak_ > kWeakFrames;
  if (is_uncertain && redetectObject(images, scene)) return;
  const bool leaving = weak_ > 0 && !clearOfBorder(mask_);
  if (cv::countNonZero(mask_) < kLeastSeen * area_px_) return lose();
  if (nothing || weak_ > kWeakFrames || leaving) return lose();
  if (!usesRule(Rule::kLeftBehind) || !isLeftBehind(patch, similarity, images, scene)) return;
  lose();
  is_place_refuted_ = true;
}

// Sets the mask to `seen`, which covers the patch's box; adds the hidden part to the whole.
void TrackedMask::setMask(const cv::Mat& seen, const ObjectRoi& patch, const FrameImages& images) {
  mask_ = wholePicture(seen, patch, images);
  const bool hidden = !patch.hidden.empty() && cv::countNonZero(patch.hidden) > 0;
  whole_ =
      hidden ? wholePicture(seen | scaleToFullSize(patch.hidden, patch), patch, images) : mask_;
}

// Removes what has been detached from the largest piece for some frames and has not the colours of
// the first mask: a hand that let go is no part of the object.
void TrackedMask::dropDetachedPieces(const ObjectRoi& patch, cv::Mat& mask) {
  const auto [labels, areas_px] = findPieces(mask);
  if (areas_px.size() <= 2) detached_ = 0;
  if (areas_px.size() <= 2 || ++detached_ < kDetachedFrames) return;
  ContourMemory at_start = memory_;
  at_start.now = at_start.first;
  const auto largest = std::max_element(areas_px.begin(), areas_px.end()) - areas_px.begin();
  for (std::size_t i = 1; i < areas_px.size(); ++i) {
    const cv::Mat piece = labels == double(i);
    const cv::Mat small = scaleToPatchSize(piece, patch);
    if (std::ptrdiff_t(i) != largest && meanEvidence(at_start, patch.color, small) < 0.0)
      mask.setTo(0, piece);
  }
  detached_ = 0;
}

// Learns the colours of a hand that touches the object for the first time.
void TrackedMask::learnTouchingHand(const ObjectRoi& patch, const cv::Mat& mask,
                                    const SceneContext& scene) {
  const cv::Mat inside = scaleToPatchSize(mask, patch);
  const cv::Mat ring = dilateBy(inside, kBand_px) & ~inside;
  const cv::Mat skin = dilateBy(erodeBy(findHand(patch.color, limits(scene)) & ~inside, 3), 3);
  if (cv::countNonZero(skin & ring) < kTouchingShare * cv::countNonZero(ring)) return;
  const ColorHistogram colors = ColorHistogram::fromImage(patch.color, skin);
  if (computeOverlap(colors, memory_.first) < kDistinctHand) learnHand(patch.color, skin);
}

void TrackedMask::learnHand(const cv::Mat& color, const cv::Mat& hand) {
  if (cv::countNonZero(hand) < kLeastHand_px || !usesRule(Rule::kHandColors)) return;
  const ColorHistogram colors = ColorHistogram::fromImage(color, hand);
  // A wall with the colours of skin is no hand.
  if (computeOverlap(colors, memory_.elsewhere) < kNotTheRoom) memory_.hand = colors;
}

// Returns whether the mask stands still without the object's colours, and these colours appear
// elsewhere: then the mask stayed on the background.
bool TrackedMask::isLeftBehind(const ObjectRoi& patch, const cv::Matx23d& similarity,
                               const FrameImages& images, const SceneContext& scene) {
  const ObjectFlow flow{.similarity = similarity, .tracks = {}};
  const cv::Point2d middle = 0.5 * (patch.box.tl() + patch.box.br());
  if (cv::norm(flow.warp(middle) - middle) > kStill_px) return false;
  const cv::Mat inside = scaleToPatchSize(mask_(patch.box), patch);
  const double own = computeOverlap(ColorHistogram::fromImage(patch.color, inside), memory_.first);
  if (own >= kOfOtherColors) doubtful_ = 0;
  if (own >= kOfOtherColors || doubtful_++ % kSearchEverywhere != 0) return false;
  const auto found = searchElsewhere(images, scene);
  return found && overlapShare(*found) == 0.0 &&
         computeOverlap(ColorHistogram::fromImage(images.color, found->mask_), memory_.first) >
             own + kClearlyUnlike;
}

void TrackedMask::rememberAppearance(const FrameImages& images, const SceneContext& scene) {
  likeness_ = computeLikeness(images, scene, mask_);
}

double TrackedMask::computeLikeness(const FrameImages& images, const SceneContext& scene,
                                    const cv::Mat& mask) const {
  const KnownObject known{memory_, limits(scene), usual_px_, mask, {}};
  return reidentificationScore(scene.view(images), known, mask);
}

void TrackedMask::correct(const FrameImages& images, const SceneContext& scene,
                          const Annotation& annotation) {
  memory_.avoided = scene.avoided.histogram;
  // Where the mask was only moved, a negative point shows that the object is not there.
  if (annotation.on.empty() && !isDecided()) return lose();
  std::erase_if(anchors_, [&](const cv::Point2f& anchor) {
    return std::any_of(annotation.off.begin(), annotation.off.end(), [&](const cv::Point& off) {
      return cv::norm(anchor - cv::Point2f(off)) < 2 * kPoint_px;  // the later point counts
    });
  });
  const std::vector<cv::Point> held = visibleAnchors();
  const cv::Mat mask =
      refineWithClicks(scene.view(images), mask_, annotation, held, kMostAgain * usual_px_);
  for (const ObjectPoint& point : annotation.on) addAnchor(point.at_px);
  const bool nothing = cv::countNonZero(mask) < kSmallestObject_px;
  if (nothing && held.empty()) return lose();
  if (nothing) return;
  // The rest of another object, without the part at the point, is not the object either.
  if (anchors_.empty() &&
      computeOverlap(ColorHistogram::fromImage(images.color, mask), memory_.first) < kOfOtherColors)
    return lose();
  adopt(mask, images, scene);
}

std::vector<cv::Point> TrackedMask::visibleAnchors() const {
  std::vector<cv::Point> out;
  for (const cv::Point2f& anchor : anchors_) {
    if (present() && contains(mask_, anchor)) out.emplace_back(anchor);
  }
  return out;
}

void TrackedMask::adopt(const cv::Mat& mask, const FrameImages& images, const SceneContext& scene) {
  const ObjectRoi patch = makePatch(images, mask);
  if (patch.empty()) return;
  // A lost object may still be partly hidden.
  const bool is_whole = present() || cv::countNonZero(mask) > kMostlyWhole * usual_px_;
  mask_ = mask;
  lost_ = 0;
  is_place_refuted_ = false;
  learnAppearance(patch, images, scene, is_whole);
  rememberAppearance(images, scene);
}

// An anchor that is outside the object after its motion has drifted, and is dropped.
void TrackedMask::moveAnchors(const cv::Matx23d& similarity) {
  for (cv::Point2f& anchor : anchors_) {
    const cv::Vec2d to = similarity * cv::Vec3d(double(anchor.x), double(anchor.y), 1.0);
    anchor = {static_cast<float>(to[0]), static_cast<float>(to[1])};
  }
  std::erase_if(anchors_, [this](const cv::Point2f& anchor) { return !contains(whole_, anchor); });
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
  detached_ = doubtful_ = 0;
  is_place_refuted_ = false;
}

}  // namespace hapticast::server
