// SPDX-License-Identifier: MIT
#include "server/vision/frame_describer.hpp"

#include <algorithm>

namespace hapticast::server {

namespace {

/// Returns whether a client accepts the frame with one more object.
bool hasRoomFor(const HapticObject& object, const HapticFrame& frame) {
  std::size_t sum = object.relief->rect.pixels();
  for (const HapticObject& other : frame.objects) sum += other.relief->rect.pixels();
  return frame.objects.size() < kMaxObjects && sum <= kMaxReliefPixels;
}

}  // namespace

void FrameDescriber::add(const std::vector<TrackedObject>& objects, const DepthNoise& noise,
                         const NominalFrame& nominal, VisionResult result,
                         std::uint64_t clip_frame) {
  addReliefs(objects, noise, nominal, result);
  const HapticFrame& frame = result.frame;
  for (const auto& report : motion_.add(frame.id, toSeconds(frame.media_time), objects))
    reports_.push_back(report);
  pending_.push_back({std::move(result), clip_frame});
  if (pending_.size() > static_cast<std::size_t>(lookahead_)) complete(nominal);
}

void FrameDescriber::completeAll(const NominalFrame& nominal) {
  while (!pending_.empty()) complete(nominal);
}

void FrameDescriber::beginEpoch() {
  motion_.forget();
  cutters_.clear();
  last_objects_.clear();
}

void FrameDescriber::addReliefs(const std::vector<TrackedObject>& objects, const DepthNoise& noise,
                                const NominalFrame& nominal, VisionResult& result) {
  HapticFrame& frame = result.frame;
  for (const TrackedObject& object : objects) {
    Described described = describeLayers(object, frame.id, last_objects_, noise, nominal, settings_,
                                         clock_, cutters_[object.id]);
    reports_.emplace_back(object.id, described.report);
    for (std::size_t i = 0; i < described.layers.size(); ++i) {
      if (!hasRoomFor(described.layers[i], frame)) continue;
      frame.objects.push_back(std::move(described.layers[i]));
      if (settings_.offline)
        result.measured.push_back(i < described.measured.size() ? described.measured[i] : nullptr);
    }
  }
  last_objects_ = frame.objects;
  std::erase_if(cutters_, [this](const auto& cutter) {
    return std::none_of(last_objects_.begin(), last_objects_.end(),
                        [&](const HapticObject& o) { return o.id == cutter.first; });
  });
}

/// Adds the motion of the window around it to the oldest frame.
void FrameDescriber::complete(const NominalFrame& nominal) {
  Pending pending = std::move(pending_.front());
  pending_.pop_front();
  motion_.complete(pending.result.frame, pending.clip_frame, nominal);
  for (const auto& report : motion_.reports()) reports_.push_back(report);
  completed_.push_back(std::move(pending.result));
}

}  // namespace hapticast::server
