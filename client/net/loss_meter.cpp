// SPDX-License-Identifier: MIT
#include "client/net/loss_meter.hpp"

#include <algorithm>
#include <cmath>

#include "client/net/frame_assembler.hpp"

namespace hapticast::client {

namespace {
// Fewer frames say nothing: one lost of twenty would be 5 %.
constexpr std::size_t kLeastFrames = 20;
constexpr double kForgets = 0.5;  // of the loss before, at each judgement; chosen
}  // namespace

void LossMeter::add(std::uint64_t frame, std::uint16_t parts) {
  const std::uint64_t newest = frames_.empty() ? judged_ : frames_.rbegin()->first;
  const std::uint64_t jump = frame > newest ? frame - newest : newest - frame;
  if (jump > FrameAssembler::kLargestJump) {  // another numbering, or the first frame
    frames_.clear();
    judged_ = ignored_ = frame > 0 ? frame - 1 : 0;
  }
  if (frame <= judged_ && judged_ > 0) return;
  Came& came = frames_[frame];
  came.parts = parts;
  ++came.came;
}

void LossMeter::again(std::uint64_t frame) {
  if (const auto found = frames_.find(frame); found != frames_.end()) ++found->second.came;
}

std::uint32_t LossMeter::copies(LocalTime now) {
  if (now - judged_at_ < kJudgeEvery || frames_.size() < kLeastFrames + kSettled) return copies_;
  judged_at_ = now;
  judge();
  if (fixed_) return copies_;
  if (needed_ >= copies_) needed_at_ = now;
  if (needed_ == copies_ || (needed_ < copies_ && now - needed_at_ < kPatience)) return copies_;
  copies_ = needed_;
  needed_at_ = now;
  // What is under way was sent in the other number.
  ignored_ = frames_.empty() ? judged_ : frames_.rbegin()->first + kSettled;
  return copies_;
}

void LossMeter::judge() {
  const std::uint64_t newest = frames_.rbegin()->first;
  const std::uint64_t until = newest > kSettled ? newest - kSettled : 0;
  double parts = 0.0, came = 0.0;
  std::uint64_t first = 0, seen = 0;
  for (auto each = frames_.begin(); each != frames_.end() && each->first <= until;) {
    if (each->first > ignored_) {
      if (first == 0) first = judged_ > ignored_ ? judged_ + 1 : each->first;
      parts += each->second.parts;
      came += std::min(each->second.came, each->second.parts * copies_);
      ++seen;
    }
    each = frames_.erase(each);
  }
  judged_ = std::max(judged_, until);
  if (seen == 0) return;
  // Of frames of which nothing came it is not known how many parts they had.
  const double frames = static_cast<double>(std::max(until - first + 1, seen));
  const double sent = parts / static_cast<double>(seen) * frames * copies_;
  const double lost = std::clamp(1.0 - came / sent, 0.0, 1.0);
  loss_ = std::max(lost, kForgets * loss_ + (1.0 - kForgets) * lost);
  needed_ = 1;
  while (needed_ < limits::kMostCopies && std::pow(loss_, needed_) > kTolerated) ++needed_;
}

}  // namespace hapticast::client
