// SPDX-License-Identifier: MIT
#include "client/net/frame_queue.hpp"

#include <numeric>
#include <utility>

namespace hapticast::client {

namespace {

/// Of the reliefs that these objects bring.
std::size_t pixelsOf(const std::vector<HapticObject>& objects) {
  return std::accumulate(objects.begin(), objects.end(), std::size_t{0},
                         [](std::size_t sum, const HapticObject& object) {
                           return sum + (object.relief ? object.relief->mask.size() : 0);
                         });
}

}  // namespace

std::size_t FrameQueue::push(AssembledFrame assembled) {
  pixels_ += pixelsOf(assembled.frame.objects);
  frames_.push_back(std::move(assembled));
  std::size_t left_out = 0;
  for (; frames_.size() > kMaxFrames || pixels_ > kMaxPixels; ++left_out) leaveOutOldest();
  return left_out;
}

std::optional<FrameQueue::Taken> FrameQueue::pop() {
  if (frames_.empty()) return std::nullopt;
  Taken taken{std::move(frames_.front()), std::exchange(kept_, {})};
  frames_.pop_front();
  pixels_ -= pixelsOf(taken.assembled.frame.objects);
  return taken;
}

void FrameQueue::clear() {
  frames_.clear();
  kept_.clear();
  pixels_ = 0;
}

void FrameQueue::leaveOutOldest() {
  const AssembledFrame oldest = std::move(frames_.front());
  frames_.pop_front();
  pixels_ -= pixelsOf(oldest.frame.objects);
  for (const HapticObject& object : oldest.frame.objects) {
    if (object.relief) keep(object);
  }
}

void FrameQueue::keep(HapticObject object) {
  std::erase_if(kept_, [&](const HapticObject& each) {
    return each.id == object.id && each.layer == object.layer;
  });
  kept_.push_back(std::move(object));
  while (kept_.size() > ReliefCache::kMaxEntries || pixelsOf(kept_) > kMaxPixels) {
    kept_.erase(kept_.begin());
  }
}

}  // namespace hapticast::client
