// SPDX-License-Identifier: MIT
#include "server/vision/segment/band_object.hpp"

#include <algorithm>

#include "server/vision/segment/search.hpp"
#include "server/vision/segment/segment.hpp"
#include "server/vision/segment/start.hpp"

namespace hapticast::server {

namespace {

constexpr double kSettled = 0.004;      // of the area: a mask that changes by less is at rest
constexpr int kWeakFrames = 5;          // chosen, in a row: then the object is lost
constexpr int kSearchEvery = 3;         // chosen: a search costs as much as a frame
constexpr double kMostlySeen = 0.6;     // chosen, of the whole: what is seen less teaches nothing
constexpr double kLeastGrowth = 0.8;    // chosen, of the area in a frame: outside of these two the
constexpr double kMostGrowth = 1.25;    // decision is not believed
constexpr double kWeaker = 0.7;         // chosen: quality of a frame that is not measured well
constexpr double kAgainColor = 0.5;     // chosen: mean colour evidence of what is found again
constexpr double kAgainSmallest = 0.3;  // chosen, likewise: of the area when last seen well
constexpr double kAgainLargest = 2.5;
constexpr double kLikeSkin = 0.2;  // chosen, of its pixels: hands cannot be told by their colour

// The colours of the picture without an object, of every second pixel and row.
ColorHistogram elsewhere(const FrameImages& images, const cv::Mat& mask) {
  ColorHistogram out;
  for (int v = 0; v < mask.rows; v += 2) {
    const auto* color = images.color.ptr<cv::Vec3b>(v);
    const auto* in = mask.ptr<unsigned char>(v);
    for (int u = 0; u < mask.cols; u += 2) {
      if (in[u] == 0) out.count(color[u]);
    }
  }
  out.settle();
  return out;
}

}  // namespace

BandObject::BandObject(std::uint32_t id, const cv::Mat& first_mask, const FrameImages& images,
                       const BandScene& scene, int most_rounds)
    : id_(id), mask_(first_mask), whole_(first_mask) {
  settle(images, scene, most_rounds);
}

void BandObject::settle(const FrameImages& images, const BandScene& scene, int most_rounds) {
  for (int round = 0; round < most_rounds; ++round) {
    const Patch patch = patchAround(images, mask_);
    if (patch.empty()) return;
    memory_ = {};
    learn(patch, mask_(patch.box), memory_);
    const cv::Mat mask = decideContour(patch, scene.noise, scene.planes, memory_).mask;
    const int changed = cv::countNonZero(mask != mask_(patch.box));
    const int area = cv::countNonZero(mask);
    if (area < kSmallestObject_px) break;
    mask_ = wholePicture(mask, patch, images);
    if (changed < kSettled * area) break;
  }
  const Patch patch = patchAround(images, mask_);
  memory_ = {};
  learn(patch, mask_(patch.box), memory_);
  memory_.elsewhere = elsewhere(images, mask_);
  const cv::Mat skin = scene.skin.in(patch.color) & patch.inside;
  like_skin_ = cv::countNonZero(skin) > kLikeSkin * cv::countNonZero(patch.inside);
  whole_ = mask_;
  seenWell(patch);
}

void BandObject::seenWell(const Patch& patch) {
  const double area = cv::countNonZero(whole_(patch.box));
  // One that leaves the picture has not become smaller.
  if (clearOfBorder(whole_) || area > area_px_) area_px_ = area;
  if (const auto depth = depthSpan(patch, patch.inside)) depth_ = *depth;
  quality_ = 1.0;
  weak_ = 0;
}

void BandObject::follow(const FrameImages& images, const ObjectFlow& flow, const BandScene& scene) {
  const ObjectLimits limits{depth_.nearest_mm(scene.noise), depth_.farthest_mm(scene.noise),
                            like_skin_ ? nullptr : &scene.skin};
  const Patch patch = patchAround(images, whole_, flow.similarity, limits);
  if (patch.empty()) return lose();
  carryEvidence(memory_, patch, flow.similarity);
  const ContourResult now = decideContour(patch, scene.noise, scene.planes, memory_);
  const double expected = cv::countNonZero(patch.inside) * patch.factor * patch.factor;
  const double area = cv::countNonZero(now.mask);
  if (area < kSmallestObject_px || expected < kSmallestObject_px) return lose();
  const double growth = area / expected;
  const bool convincing =
      growth >= kLeastGrowth && growth <= kMostGrowth && now.inside_color >= 0.0;
  const cv::Mat seen = convincing ? now.mask : atFullSize(patch.inside, patch);
  mask_ = wholePicture(seen, patch, images);
  const bool hidden = !patch.hidden.empty() && cv::countNonZero(patch.hidden) > 0;
  whole_ = hidden ? wholePicture(seen | atFullSize(patch.hidden, patch), patch, images) : mask_;
  if (!convincing) {
    quality_ *= kWeaker;
    const bool leaving = !clearOfBorder(mask_);
    if (++weak_ > kWeakFrames || leaving) lose();
    return;
  }
  seenWell(patch);
  if (!flow.reliable) quality_ = kWeaker;
  if (expected > kMostlySeen * area_px_) learn(patch, now.mask, memory_);
}

void BandObject::yieldTo(const BandObject& other) {
  // A new image: the old one is the whole's, too, and perhaps a remembered start's.
  cv::Mat rest;
  cv::bitwise_and(mask_, ~other.mask_, rest);
  mask_ = rest;
  if (cv::countNonZero(mask_) < kSmallestObject_px) lose();
}

double BandObject::shareIn(const BandObject& other) const {
  return double(cv::countNonZero(mask_ & other.mask_)) / std::max(1, cv::countNonZero(mask_));
}

void BandObject::lose() {
  lost_ = 1;
  quality_ = 0.0;
}

std::optional<BandObject> BandObject::search(const FrameImages& images, const BandScene& scene) {
  if (lost_++ % kSearchEvery != 0) return std::nullopt;
  BandObject again;
  again.mask_ = likeliestPlace(images, memory_.first, depth_.middle_mm, area_px_);
  if (again.mask_.empty()) return std::nullopt;
  again.memory_.first = memory_.first;
  again.memory_.elsewhere = memory_.elsewhere;
  again.like_skin_ = like_skin_;
  Patch patch;
  for (int round = 0; round < kSettleRounds; ++round) {
    again.memory_.evidence.release();
    patch = patchAround(images, again.mask_);
    if (patch.empty()) return std::nullopt;
    learn(patch, again.mask_(patch.box), again.memory_);
    const ContourResult now = decideContour(patch, scene.noise, scene.planes, again.memory_);
    const int changed = cv::countNonZero(now.mask != again.mask_(patch.box));
    const int area = cv::countNonZero(now.mask);
    if (area < kSmallestObject_px || now.inside_color < kAgainColor) return std::nullopt;
    again.mask_ = wholePicture(now.mask, patch, images);
    if (changed < kSettled * area) break;
  }
  const double ratio = cv::countNonZero(again.mask_) / area_px_;
  if (ratio < kAgainSmallest || ratio > kAgainLargest || !clearOfBorder(again.mask_))
    return std::nullopt;
  again.whole_ = again.mask_;
  again.seenWell(patch);
  again.area_px_ = std::max(again.area_px_, area_px_);  // what was found may be a part of it
  return again;
}

}  // namespace hapticast::server
