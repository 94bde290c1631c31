// SPDX-License-Identifier: MIT
#include "server/source/pacer.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::server {

Pacer::Pacer(double fps, MediaTime start) : fps_(fps), start_(start) {}

MediaTime Pacer::slotTime(std::uint64_t slot) const {
  // Computed from the slot's number and not summed, so that rounding errors do not accumulate.
  return start_ + Duration(std::llround(static_cast<double>(slot) * 1e9 / fps_));
}

Pacer::Plan Pacer::plan(MediaTime now) {
  Duration late = now - slotTime(next_slot_);
  if (late > kLongestSkip) {
    start_ += late;
    late = Duration::zero();
  }
  std::uint64_t skip = 0;
  if (late > Duration::zero()) {
    skip = static_cast<std::uint64_t>(toSeconds(late) * fps_);
    // The division may be off by one if `now` is at a slot.
    while (skip > 0 && slotTime(next_slot_ + skip) > now) --skip;
    while (slotTime(next_slot_ + skip + 1) <= now) ++skip;
  }
  slot_ = next_slot_ + skip;
  step_ = skip + 1;
  return {skip, slotTime(slot_)};
}

void Pacer::resume(MediaTime now) {
  start_ += std::max(now - slotTime(next_slot_), Duration::zero());
}

MediaTime Pacer::frameRead(std::uint32_t epoch, std::uint64_t index) {
  if (any_read_ && epoch == last_epoch_ && index > last_index_ + step_)
    slot_ += index - last_index_ - step_;
  next_slot_ = slot_ + 1;
  skipped_ += step_ - 1;
  any_read_ = true;
  last_epoch_ = epoch;
  last_index_ = index;
  return slotTime(slot_);
}

std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop) {
  while (skip > 0 && source.skip()) --skip;
  if (skip == 0) {
    if (auto frame = source.read()) return frame;
  }
  if (!loop || source.info().live) return std::nullopt;
  source.rewind();
  return source.read();
}

}  // namespace hapticast::server
