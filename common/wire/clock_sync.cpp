// SPDX-License-Identifier: MIT
#include "common/wire/clock_sync.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticast {

namespace {
/// A slope needs this much time between the samples it is taken from.
constexpr Duration kSlopeSpan = std::chrono::seconds(20);

double nanoseconds(Duration duration) { return static_cast<double>(duration.count()); }
}  // namespace

void ClockSync::add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3) {
  const Duration round_trip = (t3 - t0) - (t2 - t1);
  if (t3 < t0 || t2 < t1 || round_trip < Duration::zero()) return;
  const LocalTime middle = t0 + (t3 - t0) / 2;
  const MediaTime middle_there = t1 + (t2 - t1) / 2;
  samples_.push_back(
      {middle, middle_there.time_since_epoch() - middle.time_since_epoch(), round_trip});
  if (samples_.size() > kWindow) samples_.pop_front();
  if (ready()) fit();
}

void ClockSync::fit() {
  // The quickest quarter waited in no queue on the way, so it hides the least asymmetry.
  std::vector<Sample> best(samples_.begin(), samples_.end());
  const auto count = static_cast<std::ptrdiff_t>(std::max<std::size_t>(best.size() / 4, 2));
  std::partial_sort(best.begin(), best.begin() + count, best.end(),
                    [](const Sample& a, const Sample& b) { return a.round_trip < b.round_trip; });
  best.resize(static_cast<std::size_t>(count));

  const auto [first, last] = std::minmax_element(
      best.begin(), best.end(), [](const Sample& a, const Sample& b) { return a.time < b.time; });
  const Duration span = last->time - first->time;
  line_ = {best.front().time, best.front().offset, 0.0, 0.0, Duration::zero()};
  const Duration base = line_.base;
  double mean_time = 0.0, mean_offset = 0.0;
  for (const Sample& each : best) {
    mean_time += nanoseconds(each.time - line_.origin) / static_cast<double>(count);
    mean_offset += nanoseconds(each.offset - base) / static_cast<double>(count);
    line_.error += each.round_trip / (2 * count);
  }
  if (span >= kSlopeSpan) {
    double covariance = 0.0, variance = 0.0;
    for (const Sample& each : best) {
      const double time = nanoseconds(each.time - line_.origin) - mean_time;
      covariance += time * (nanoseconds(each.offset - base) - mean_offset);
      variance += time * time;
    }
    line_.slope = std::clamp(covariance / variance, -kMaxDrift, kMaxDrift);
  }
  line_.value_ns = mean_offset - line_.slope * mean_time;
}

Duration ClockSync::offset(LocalTime now) {
  const double ahead = line_.value_ns + line_.slope * nanoseconds(now - line_.origin);
  const Duration wanted = line_.base + Duration(std::llround(ahead));
  if (!handed_out_) {
    handed_out_ = true;
    offset_ = wanted;
  } else {
    const Duration step(
        std::llround(kMaxDrift * nanoseconds(std::max(now - last_, Duration::zero()))));
    offset_ = std::clamp(wanted, offset_ - step, offset_ + step);
  }
  behind_ = std::chrono::abs(wanted - offset_);
  last_ = now;
  return offset_;
}

Duration ClockSync::errorBound() const { return line_.error + behind_; }

}  // namespace hapticast
