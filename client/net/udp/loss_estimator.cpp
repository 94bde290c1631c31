// SPDX-License-Identifier: MIT
#include "client/net/udp/loss_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "client/net/frame_assembler.hpp"

namespace hapticast::client {

namespace {
// Fewer frames allow no estimate: one lost fragment of twenty would be 5 %.
constexpr std::size_t kLeastFrames = 20;
// Chosen: the first fragments of a larger frame suffice, and memory is bounded.
constexpr std::size_t kMostParts = 256;
// A k-th send counts as such from this share on. Chosen: duplicates by the network are rarer, and
// up to half of the sends may be lost.
constexpr double kCopiesAreSent = 0.05;
constexpr double kForgets = 0.5;  // weight of the old estimate at each update; chosen

void blendIn(double& share, double now) {
  share = std::max(now, kForgets * share + (1.0 - kForgets) * now);
}
}  // namespace

void LossEstimator::add(const DatagramHeader& header) {
  const std::uint64_t newest = frames_.empty() ? judged_ : frames_.rbegin()->first;
  const bool first = frames_.empty() && judged_ == 0;
  if (first || FrameAssembler::jump(newest, header.frame)) {
    frames_.clear();
    judged_ = header.frame > 0 ? header.frame - 1 : 0;
    // Of the first frames the first sends came before this connection.
    ignored_ = judged_ + limits::kMostCopies;
  }
  if (header.frame <= judged_ && judged_ > 0) return;
  Reception& received = frames_[header.frame];
  if (received.empty()) received.resize(std::min<std::size_t>(header.parts, kMostParts));
  count(received, header.part);
}

void LossEstimator::onDuplicate(const DatagramHeader& header) {
  if (const auto found = frames_.find(header.frame); found != frames_.end())
    count(found->second, header.part);
}

void LossEstimator::count(Reception& received, std::size_t part) {
  if (part < received.size() && received[part] < limits::kMostCopies) ++received[part];
}

std::uint32_t LossEstimator::copies(LocalTime now) {
  if (now - judged_at_ < kJudgeEvery || frames_.size() < kLeastFrames + kSettled) return copies_;
  judged_at_ = now;
  judge();
  if (fixed_) return copies_;
  if (needed_ >= copies_ || !needed_at_) needed_at_ = now;
  const Duration patience = changed_ ? kPatience : kFirstPatience;
  if (needed_ == copies_ || (needed_ < copies_ && now - *needed_at_ < patience)) return copies_;
  changed_ = true;
  copies_ = needed_;
  needed_at_ = now;
  lost_ = lost_fewer_ = 0.0;
  // Datagrams under way have the previous redundancy.
  ignored_ = frames_.empty() ? judged_ : frames_.rbegin()->first + kSettled;
  return copies_;
}

LossEstimator::Tally LossEstimator::popSettled() {
  const std::uint64_t newest = frames_.rbegin()->first;
  const std::uint64_t until = newest > kSettled ? newest - kSettled : 0;
  Tally tally;
  std::uint64_t first = 0, seen = 0;
  for (auto each = frames_.begin(); each != frames_.end() && each->first <= until;) {
    if (each->first > ignored_) {
      if (first == 0) first = judged_ > ignored_ ? judged_ + 1 : each->first;
      for (const std::uint8_t times : each->second) {
        for (std::size_t k = 0; k <= times; ++k) ++tally.parts[k];
      }
      ++seen;
    }
    each = frames_.erase(each);
  }
  judged_ = std::max(judged_, until);
  // The number of fragments of a completely lost frame is unknown: extrapolate.
  if (seen > 0)
    tally.parts[0] *=
        static_cast<double>(std::max(until - first + 1, seen)) / static_cast<double>(seen);
  return tally;
}

void LossEstimator::judge() {
  const Tally tally = popSettled();
  const double sent = tally.parts[0];
  if (sent == 0.0) return;
  std::uint32_t copies = 1;
  double received = tally.parts[1];
  while (copies < limits::kMostCopies && tally.parts[copies + 1] > kCopiesAreSent * sent)
    received += tally.parts[++copies];
  blendIn(loss_, 1.0 - received / (sent * copies));
  blendIn(lost_, 1.0 - tally.parts[1] / sent);
  // With one send less, a fragment that arrived once would be lost with a probability of 1/copies.
  blendIn(lost_fewer_,
          1.0 - tally.parts[1] / sent + (tally.parts[1] - tally.parts[2]) / sent / copies);
  needed_ = copies;
  if (lost_ > kTolerated) {
    // The redundancy that independent losses require. If it is in use already, losses occur in
    // bursts: use the maximum, which spreads the sends farthest in time.
    while (needed_ < limits::kMostCopies && std::pow(loss_, needed_) > kTolerated) ++needed_;
    if (needed_ == copies) needed_ = limits::kMostCopies;
  } else if (lost_fewer_ <= kTolerated) {
    needed_ = std::max(copies - 1, 1U);
  }
}

}  // namespace hapticast::client
