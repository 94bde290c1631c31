// SPDX-License-Identifier: MIT
#include "client/net/frame_assembler.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hapticast::client {

namespace {

/// Returns true if the reliefs differ, as far as both have slices.
bool differ(const CodedRelief& a, const CodedRelief& b) {
  const auto within = [](const CodedRelief& part, const CodedRelief& whole) {
    return std::all_of(part.slices.begin(), part.slices.end(), [&](const SliceBytes& slice) {
      return std::find(whole.slices.begin(), whole.slices.end(), slice) != whole.slices.end();
    });
  };
  return a.rect != b.rect || a.slice_count != b.slice_count ||
         (b.whole() ? !within(a, b) : a.whole() && !within(b, a));
}

bool differ(const CodedObject& a, const CodedObject& b) {
  return a.changed_in_frame != b.changed_in_frame || a.motion != b.motion ||
         a.impacts != b.impacts || a.material != b.material ||
         (a.relief && b.relief && differ(*a.relief, *b.relief)) ||
         (a.grid && b.grid && *a.grid != *b.grid);
}

/// Returns true if two versions of a frame differ. One of them may lack reliefs that did not
/// change, and slices or grids that have not arrived.
bool differ(const CodedFrame& a, const CodedFrame& b) {
  if (a.epoch != b.epoch || a.media_time != b.media_time || a.objects.size() != b.objects.size())
    return true;
  return std::any_of(a.objects.begin(), a.objects.end(), [&](const CodedObject& object) {
    const auto same =
        std::find_if(b.objects.begin(), b.objects.end(),
                     [&](const CodedObject& other) { return makeKey(other) == makeKey(object); });
    return same == b.objects.end() || differ(object, *same);
  });
}

/// Sum of the received bytes of all frames.
template <class Frames>
std::size_t countBytes(const Frames& frames) {
  return std::accumulate(
      frames.begin(), frames.end(), std::size_t{0},
      [](std::size_t sum, const auto& each) { return sum + each.second.bytes(); });
}

}  // namespace

void FrameAssembler::restart() {
  ++epoch_;
  server_epoch_.reset();
  last_id_.reset();
  forget();
  late_.clear();
  contradicted_ = false;
}

void FrameAssembler::forget() {
  waiting_.clear();
  left_.clear();
  done_.clear();
  by_tcp_.clear();
  compared_.clear();
}

bool FrameAssembler::contradicts(const CodedFrame& frame, const Reassembly* joined) {
  const auto left = compared_.find(frame.id);
  contradicted_ = (left != compared_.end() && differ(frame, left->second)) ||
                  (joined != nullptr && joined->hasHead() && differ(frame, joined->frame()));
  if (contradicted_) forget();
  return contradicted_;
}

bool FrameAssembler::behind(std::uint64_t id) const { return last_id_ && id <= *last_id_; }

bool FrameAssembler::jumps(std::uint64_t id) const { return last_id_ && jump(*last_id_, id); }

bool FrameAssembler::add(CodedFrame frame, LocalTime arrived) {
  const std::uint64_t id = frame.id;
  if (contradicted_) return false;
  if (jumps(id)) {
    forget();
  } else if (behind(id)) {
    const auto left = left_.find(id);
    (void)contradicts(frame, left != left_.end() ? &left->second : nullptr);
    return false;
  }
  if (const auto known = waiting_.find(id); known != waiting_.end()) {
    const Waiting& other = known->second;
    if (contradicts(frame, other.joined ? &*other.joined : nullptr)) return false;
  }
  Waiting& waiting = waiting_[id];
  // Before the first frame only TCP brings all reliefs.
  if (waiting.frame || (last_id_ && waiting.joined && waiting.joined->whole())) return false;
  waiting.frame = std::move(frame);
  waiting.arrived = arrived;
  return true;
}

std::uint64_t FrameAssembler::newest() const {
  const std::uint64_t left = last_id_.value_or(0);
  return waiting_.empty() ? left : std::max(left, waiting_.rbegin()->first);
}

FrameAssembler::Want FrameAssembler::classify(const DatagramHeader& part) const {
  if (contradicted_) return Want::kHad;
  const std::uint64_t newest_id = newest();
  const bool any = last_id_ || !waiting_.empty();
  const bool astray = part.frame > newest_id ? part.frame - newest_id > kLargestJump
                                             : newest_id - part.frame > kOldestPart;
  if (any && astray) return Want::kAstray;
  const auto lacking = [&](const Reassembly& joined) {
    return joined.lacks(part) ? Want::kNew : Want::kHad;
  };
  if (const auto waiting = waiting_.find(part.frame); waiting != waiting_.end())
    return waiting->second.joined ? lacking(*waiting->second.joined) : Want::kNew;
  if (const auto left = left_.find(part.frame); left != left_.end()) return lacking(left->second);
  return done_.contains(part.frame) ? Want::kHad : Want::kNew;
}

Result<bool, WireError> FrameAssembler::add(const DatagramHeader& part,
                                            std::span<const std::uint8_t> payload,
                                            LocalTime arrived) {
  if (behind(part.frame)) return addLate(part, payload, arrived);
  Waiting& waiting = waiting_[part.frame];
  // The frame may have been skipped without its head, which arrives now.
  if (auto left = left_.extract(part.frame)) waiting.joined.emplace(std::move(left.mapped()));
  if (!waiting.joined) waiting.joined.emplace(part);
  if (!waiting.frame) waiting.arrived = arrived;
  if (auto error = waiting.joined->add(part, payload)) {
    waiting.joined.reset();
    if (!waiting.frame) waiting_.erase(part.frame);
    abandon(part.frame);
    return *error;
  }
  const bool whole = waiting.joined->whole();
  if (waiting.frame) (void)contradicts(CodedFrame(*waiting.frame), &*waiting.joined);
  return whole;
}

Result<bool, WireError> FrameAssembler::addLate(const DatagramHeader& part,
                                                std::span<const std::uint8_t> payload,
                                                LocalTime arrived) {
  Reassembly& joined = left_.try_emplace(part.frame, part).first->second;
  if (auto error = joined.add(part, payload)) {
    left_.erase(part.frame);
    abandon(part.frame);
    return *error;
  }
  const bool whole = joined.whole();
  if (const auto left = compared_.find(part.frame);
      left != compared_.end() && contradicts(CodedFrame(left->second), &joined))
    return false;
  // The frame remains in left_: it completes reliefs that later frames declare unchanged.
  if (whole && !by_tcp_.contains(part.frame)) late_.push_back({part.media_time, arrived});
  boundLeft();
  return whole;
}

void FrameAssembler::abandon(std::uint64_t id) {
  done_.insert(id);
  if (done_.size() > kLargestJump + kOldestPart) done_.erase(done_.begin());
}

void FrameAssembler::boundLeft() {
  while (left_.size() > kOldestPart || countBytes(left_) > kMaxBytes) left_.erase(left_.begin());
}

std::optional<MediaTime> FrameAssembler::findLastLeft() const {
  return last_id_ ? std::optional(last_media_time_) : std::nullopt;
}

std::optional<LocalTime> FrameAssembler::oldestCame() const {
  return waiting_.empty() ? std::nullopt : std::optional(waiting_.begin()->second.arrived);
}

bool FrameAssembler::isOverfull() const {
  return waiting_.size() > kMaxWaiting || countBytes(waiting_) > kMaxBytes;
}

void FrameAssembler::dropBeforeTcp() {
  const auto first = std::find_if(waiting_.begin(), waiting_.end(),
                                  [](const auto& each) { return each.second.frame.has_value(); });
  if (first != waiting_.end()) waiting_.erase(waiting_.begin(), first);
}

bool FrameAssembler::follows(const Reassembly& joined) const {
  if (last_id_) return joined.header().frame == *last_id_ + 1;
  const CodedFrame frame = joined.frame();
  return std::all_of(frame.objects.begin(), frame.objects.end(),
                     [](const CodedObject& object) { return object.relief != nullptr; });
}

std::optional<AssembledFrame> FrameAssembler::next(bool due) {
  if (!last_id_) dropBeforeTcp();
  while (!waiting_.empty()) {
    const auto oldest = waiting_.begin();
    Waiting& waiting = oldest->second;
    const std::uint64_t id = oldest->first;
    const bool ready = waiting.frame || (waiting.joined->whole() && follows(*waiting.joined));
    // No frame is due before the first one was played.
    if (!ready && !((due && last_id_) || isOverfull())) return std::nullopt;
    Waiting accepted = std::move(waiting);
    waiting_.erase(oldest);
    if (accepted.frame) {
      by_tcp_.insert(id);
      if (accepted.joined) left_.insert_or_assign(id, std::move(*accepted.joined));
      boundLeft();
      return remove(std::move(*accepted.frame), accepted.arrived);
    }
    if (auto frame = removeReassembly(id, std::move(accepted))) return frame;
  }
  return std::nullopt;
}

std::optional<AssembledFrame> FrameAssembler::removeReassembly(std::uint64_t id, Waiting waiting) {
  Reassembly& joined = *waiting.joined;
  const bool whole = joined.whole();
  // Without its head an object would seem to have disappeared.
  std::optional<CodedFrame> frame;
  if (joined.hasHead()) frame = joined.frame();
  if (whole) {
    abandon(id);
  } else {
    left_.insert_or_assign(id, std::move(joined));
    boundLeft();
  }
  if (!frame) return std::nullopt;
  return remove(std::move(*frame), whole ? std::optional(waiting.arrived) : std::nullopt);
}

AssembledFrame FrameAssembler::remove(CodedFrame frame, std::optional<LocalTime> arrived) {
  const bool resync = jumps(frame.id);
  // The first frame after restart() has the epoch that was announced to the loop.
  if (resync || (server_epoch_ && *server_epoch_ != frame.epoch)) ++epoch_;
  server_epoch_ = frame.epoch;
  FramePlace place{epoch_, !last_id_, resync, 0, frame.media_time, {}, arrived};
  if (last_id_ && !resync) {
    place.lost = frame.id - *last_id_ - 1;
    place.gap = frame.media_time - last_media_time_;
  }
  last_id_ = frame.id;
  last_media_time_ = frame.media_time;
  compared_.insert_or_assign(frame.id, frame);
  if (compared_.size() > kMaxCompared) compared_.erase(compared_.begin());
  forgetOld();
  fillUp(frame);
  return {place, std::move(frame)};
}

void FrameAssembler::fillUp(CodedFrame& frame) {
  for (CodedObject& object : frame.objects) {
    const auto left = left_.find(object.changed_in_frame);
    if (!object.relief && left != left_.end()) object.relief = left->second.relief(makeKey(object));
  }
}

void FrameAssembler::forgetOld() {
  const std::uint64_t oldest = *last_id_ > kOldestPart ? *last_id_ - kOldestPart : 0;
  std::erase_if(left_, [&](const auto& each) { return each.first < oldest; });
  std::erase_if(by_tcp_, [&](std::uint64_t id) { return id < oldest || id > *last_id_; });
  std::erase_if(done_,
                [&](std::uint64_t id) { return id < oldest || id > *last_id_ + kLargestJump; });
}

std::optional<LateFrame> FrameAssembler::takeLate() {
  if (late_.empty()) return std::nullopt;
  const LateFrame first = late_.front();
  late_.pop_front();
  return first;
}

}  // namespace hapticast::client
