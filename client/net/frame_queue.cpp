// SPDX-License-Identifier: MIT
#include "client/net/frame_queue.hpp"

#include <numeric>
#include <utility>

namespace hapticast::client {

namespace {

/// Bytes of the reliefs of these objects.
std::size_t countBytes(const std::vector<CodedObject>& objects) {
  return std::accumulate(objects.begin(), objects.end(), std::size_t{0},
                         [](std::size_t sum, const CodedObject& object) {
                           return sum + (object.relief ? object.relief->bytes() : 0);
                         });
}

}  // namespace

std::size_t FrameQueue::push(AssembledFrame assembled) {
  bytes_ += countBytes(assembled.frame.objects);
  frames_.push_back(std::move(assembled));
  std::size_t left_out = 0;
  for (; frames_.size() > kMaxFrames || bytes_ > kMaxBytes; ++left_out) dropOldest();
  return left_out;
}

std::optional<FrameQueue::Accepted> FrameQueue::pop() {
  if (frames_.empty()) return std::nullopt;
  Accepted accepted{std::move(frames_.front()), std::exchange(kept_, {})};
  frames_.pop_front();
  bytes_ -= countBytes(accepted.assembled.frame.objects);
  return accepted;
}

void FrameQueue::clear() {
  frames_.clear();
  kept_.clear();
  bytes_ = 0;
}

void FrameQueue::dropOldest() {
  const AssembledFrame oldest = std::move(frames_.front());
  frames_.pop_front();
  bytes_ -= countBytes(oldest.frame.objects);
  for (const CodedObject& object : oldest.frame.objects) {
    if (object.relief) push(object);
  }
}

void FrameQueue::push(CodedObject object) {
  std::erase_if(kept_, [&](const CodedObject& each) { return makeKey(each) == makeKey(object); });
  kept_.push_back(std::move(object));
  while (kept_.size() > ReliefCache::kMaxEntries || countBytes(kept_) > kMaxBytes) {
    kept_.erase(kept_.begin());
  }
}

}  // namespace hapticast::client
