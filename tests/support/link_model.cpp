// SPDX-License-Identifier: MIT
#include "tests/support/link_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticast::testing {

LinkModel::LinkModel(LinkWay& way, std::uint32_t flow) : way_(way) {
  std::seed_seq seed{way.profile.seed, std::uint64_t{flow}};
  random_.seed(seed);
}

double LinkModel::chance() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }

bool LinkModel::lost() {
  const LinkProfile& profile = way_.profile;
  const double drawn = chance();
  if (profile.burst <= 1.0 || profile.loss >= 1.0) return drawn < profile.loss;
  // Gilbert's two states: a run of losses ends after each with 1 in `burst`, and begins so often
  // that the share of lost ones is `loss`.
  const double begins = profile.loss / (profile.burst * (1.0 - profile.loss));
  losing_ = drawn < (losing_ ? 1.0 - 1.0 / profile.burst : begins);
  return losing_;
}

Duration LinkModel::travel() {
  const LinkProfile& profile = way_.profile;
  const double first = chance(), second = chance();  // as many for each kind: others stay the same
  double jitters = first;
  if (profile.distribution == Jitter::kExponential) jitters = -std::log(first);
  if (profile.distribution == Jitter::kNormal) {
    jitters = std::sqrt(-2.0 * std::log(first)) * std::cos(2.0 * std::numbers::pi * second);
  }
  return std::max(Duration(0), profile.delay + fromSeconds(jitters * toSeconds(profile.jitter)));
}

bool LinkModel::room(LocalTime now, std::size_t bytes) const {
  const LinkProfile& profile = way_.profile;
  const double waiting_bytes = toSeconds(way_.free_at - now) * profile.rate_bits_s / 8.0;
  return waiting_bytes <= 0.0 ||
         waiting_bytes + static_cast<double>(bytes) <= static_cast<double>(profile.queue_bytes);
}

LocalTime LinkModel::leave(LocalTime now, std::size_t bytes) {
  const double rate_bits_s = way_.profile.rate_bits_s;
  if (rate_bits_s <= 0.0) return now;
  way_.free_at =
      std::max(way_.free_at, now) + fromSeconds(8.0 * static_cast<double>(bytes) / rate_bits_s);
  return way_.free_at;
}

LinkModel::Arrivals LinkModel::datagram(LocalTime now, std::size_t bytes) {
  const LinkProfile& profile = way_.profile;
  LinkCounts& counts = way_.counts;
  ++counts.packets;
  counts.bytes += bytes;
  // Always the same draws, so that a change of one thing leaves the others as they were.
  const bool lost_now = lost();
  const Duration travel_once = travel(), travel_again = travel();
  const bool again = chance() < profile.duplicate;
  const bool overtaken = chance() < profile.reorder;
  const Duration held = fromSeconds(chance() * toSeconds(kHeldBack));
  if (bytes > profile.largest_bytes) return ++counts.too_large, Arrivals{};
  if (!room(now, bytes + kHeaderBytes)) return ++counts.overflowed, Arrivals{};
  const LocalTime left = leave(now, bytes + kHeaderBytes);
  if (lost_now) return ++counts.lost, Arrivals{};
  Arrivals arrivals{{std::max(left + travel_once, last_)}, 1};
  if (overtaken) {
    arrivals.at[0] = left + travel_once + held;
    ++counts.reordered;
  } else {
    last_ = arrivals.at[0];
  }
  if (again) {
    arrivals.at[arrivals.count++] = std::max(left + travel_again, arrivals.at[0]);
    ++counts.duplicated;
  }
  ++counts.deliveries;
  counts.delay += arrivals.at[0] - now;
  return arrivals;
}

LocalTime LinkModel::stream(LocalTime now, std::size_t bytes) {
  LinkCounts& counts = way_.counts;
  bool resent = false;
  for (std::size_t sent = 0; sent < bytes; sent += kSegmentBytes) {
    ++counts.packets;
    if (!lost()) continue;
    ++counts.lost;
    resent = true;
  }
  counts.bytes += bytes;
  LocalTime at = leave(now, bytes) + travel();
  if (resent) at += std::max(2 * way_.profile.delay, kLeastResend);
  last_ = std::max(last_, at);
  ++counts.deliveries;
  counts.delay += last_ - now;
  return last_;
}

}  // namespace hapticast::testing
