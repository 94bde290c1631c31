// SPDX-License-Identifier: MIT
// Search for a lost or doubtful object: part of TrackedMask.
#include <algorithm>
#include <cmath>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/follow/redetect.hpp"
#include "server/vision/segment/follow/tracked_mask.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr double kClearlyBetter = 0.12;
constexpr double kAsUsual = 0.1;  // chosen, ln of an area: largest loss
constexpr int kAgainRounds = 3;
constexpr double kNearest = 0.6;  // chosen, of its last depth: range of the search
constexpr double kFarthest = 1.6;
constexpr double kSearchReach = 1.5;  // chosen, widths of the object around its last place
constexpr double kMostUnlike = 1.2;   // of its initial score: limit for the tracked object
// Limits for a found object, chosen: how much its score may lie below the initial one, and the
// least overlap of its colours with the first ones.
constexpr LikeLimits kLikeNear{1.2, 0.6};
constexpr LikeLimits kLikeEverywhere{0.5, 0.75};
// Chosen: in the box that the correlation filter found, the place is evidence too.
constexpr LikeLimits kLikeInBox{1.2, 0.45};
constexpr double kBoxReach = 0.3;  // chosen, widths of the object around that box

}  // namespace

// Searches for the object by one graph cut. Returns true if that decides: the result is better than
// the propagated mask, or neither resembles the object.
bool TrackedMask::redetectObject(const FrameImages& images, const SceneContext& scene) {
  const KnownObject known{memory_, limits(scene), usual_px_, mask_, {}};
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
  memory_.forgetPlace();
  resetToVisible(makePatch(images, mask_));
  return true;
}

std::optional<TrackedMask> TrackedMask::search(const FrameImages& images, const SceneContext& scene,
                                               const std::optional<cv::Rect>& box) {
  const bool everywhere = lost_++ % kSearchEverywhere == 0;
  if (is_place_refuted_) return searchElsewhere(images, scene);
  const cv::Rect tight = findBoxAround(last_sure_, 0);
  const cv::Rect near =
      findBoxAround(last_sure_, int(kSearchReach * std::max(tight.width, tight.height)));
  if (auto again = searchIn(near, kLikeNear, images, scene)) return again;
  if (box) {
    const int reach_px = 10 + int(kBoxReach * std::max(box->width, box->height));
    const cv::Rect around = growRect(*box, reach_px, images.color.size());
    if (auto again = searchIn(around, kLikeInBox, images, scene)) return again;
  }
  return everywhere ? searchElsewhere(images, scene) : std::nullopt;
}

std::optional<TrackedMask> TrackedMask::searchElsewhere(const FrameImages& images,
                                                        const SceneContext& scene) const {
  return searchIn({}, kLikeEverywhere, images, scene);
}

std::optional<TrackedMask> TrackedMask::searchIn(const cv::Rect& window, const LikeLimits& least,
                                                 const FrameImages& images,
                                                 const SceneContext& scene) const {
  const ObjectLimits anywhere{kNearest * depth_.middle_mm, kFarthest * depth_.middle_mm,
                              &scene.skin, computeColorEvidence(memory_)};
  const KnownObject known{memory_, anywhere, usual_px_, {}, window};
  const FrameContext view = scene.view(images);
  const cv::Mat found = redetect(view, known);
  if (found.empty() || cv::countNonZero(found) < kSmallestObject_px) return std::nullopt;
  TrackedMask again = *this;
  again.mask_ = again.whole_ = found;
  for (int round = 0; round < kAgainRounds; ++round) {
    const ObjectRoi patch = makePatch(images, again.mask_);
    if (patch.empty()) return std::nullopt;
    again.memory_.forgetPlace();  // belongs to another patch
    const ContourResult now = decideContour(patch, scene.noise, scene.planes, again.memory_);
    if (cv::countNonZero(now.mask) < kSmallestObject_px) return std::nullopt;
    again.mask_ = wholePicture(now.mask, patch, images);
  }
  const double like = reidentificationScore(view, known, again.mask_);
  const double colors =
      computeOverlap(ColorHistogram::fromImage(images.color, again.mask_), memory_.first);
  if (like < likeness_ - least.less || colors < least.colors ||
      cv::countNonZero(again.mask_) > kMostAgain * usual_px_)
    return std::nullopt;
  again.whole_ = again.mask_;
  again.lost_ = 0;
  again.is_place_refuted_ = false;
  again.resetToVisible(makePatch(images, again.mask_));
  // The found mask may be a part of the object.
  again.area_px_ = std::max(again.area_px_, area_px_);
  again.usual_px_ = usual_px_;
  return again;
}

}  // namespace hapticast::server
