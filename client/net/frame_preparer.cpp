// SPDX-License-Identifier: MIT
#include "client/net/frame_preparer.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "client/haptics/playback/fill_slot.hpp"

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
  Accepted accepted{std::move(frames_.front()), std::exchange(kept_, {}),
                    std::exchange(begins_, std::nullopt)};
  frames_.pop_front();
  bytes_ -= countBytes(accepted.assembled.frame.objects);
  return accepted;
}

void FrameQueue::holdBack(Duration duration) {
  for (AssembledFrame& assembled : frames_) assembled.place.left += duration;
}

void FrameQueue::reset(const Workspace& workspace) {
  frames_.clear();
  kept_.clear();
  bytes_ = 0;
  begins_ = workspace;
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

void LossWatch::onFrame(const FramePlace& place, std::uint64_t id, bool after_drop) {
  // A server repeats every relief within a second; with a margin.
  constexpr Duration kRepeated = std::chrono::seconds(2);
  if (place.media_time - lost_at_ > kRepeated) complete_from_ = 0;
  if (place.lost == 0 && place.arrived && !place.resync && !after_drop) return;
  complete_from_ = place.arrived ? id : id + 1;
  lost_at_ = place.media_time;
}

FramePreparer::FramePreparer(FramePool& pool, const Clock& clock, Method method,
                             std::function<void(const PreparedFrame&)> done)
    : pool_(pool), clock_(clock), method_(method), done_(std::move(done)) {}

void FramePreparer::begin(const FrameQueue::Accepted& accepted) {
  if (accepted.begins) {
    reliefs_.reset(*accepted.begins, method_);
    losses_ = {};
  }
  const AssembledFrame& assembled = accepted.assembled;
  losses_.onFrame(assembled.place, assembled.frame.id, !accepted.left_out.empty());
  const std::uint32_t epoch = assembled.place.epoch;
  if (std::exchange(epoch_, epoch) != epoch) reliefs_.forget();
  for (const CodedObject& object : accepted.left_out) reliefs_.remember(object, assembled.frame.id);
}

void FramePreparer::prepare(const FrameQueue::Accepted& accepted) {
  begin(accepted);
  const AssembledFrame& assembled = accepted.assembled;
  PreparedFrame result;
  result.id = assembled.frame.id;
  result.place = assembled.place;
  FramePool::Index index = 0;
  result.handed_over = pool_.acquire(index);
  if (result.handed_over) {
    fill(pool_.slot(index), assembled, result);
  } else {
    // Later frames may declare the reliefs of this frame unchanged.
    for (const CodedObject& object : assembled.frame.objects)
      reliefs_.remember(object, assembled.frame.id);
  }
  result.ready = clock_.now();
  if (result.handed_over) pool_.publish(index);
  done_(result);
}

void FramePreparer::fill(FramePool::Slot& slot, const AssembledFrame& assembled,
                         PreparedFrame& result) {
  const CodedFrame& frame = assembled.frame;
  const std::size_t count = std::min(frame.objects.size(), kMaxObjects);
  for (std::size_t i = 0; i < count; ++i) {
    setObject(slot, i, frame.objects[i], resolve(frame.objects[i], frame.id, result));
  }
  completeFrame(slot, frame, assembled.place.epoch, count);
  result.playable = {
      frame.media_time,
      {slot.fields.begin(), slot.fields.begin() + static_cast<std::ptrdiff_t>(count)}};
}

std::shared_ptr<const HeightField> FramePreparer::resolve(const CodedObject& object,
                                                          std::uint64_t frame_id,
                                                          PreparedFrame& result) {
  ReliefCache::Resolved relief = reliefs_.resolve(object, frame_id);
  if (relief.rejected) ++result.reliefs_rejected;
  const bool missing = !relief.field && !relief.rejected;
  if (missing && !losses_.mayBeLost(object.changed_in_frame)) ++result.reliefs_missing;
  result.slices_lost += relief.slices_lost;
  result.slices_refused += relief.slices_refused;
  return std::move(relief.field);
}

}  // namespace hapticast::client
