// SPDX-License-Identifier: MIT
#include "common/transport/clock_sync.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace hapticast {

namespace {
/// Least time span of samples for a slope; chosen: over less, a jitter of 20 ms exceeds the drift
/// of clocks.
constexpr Duration kSlopeSpan = std::chrono::seconds(40);

double nanoseconds(Duration duration) { return static_cast<double>(duration.count()); }

struct Point {
  double time_ns, offset_ns;
};

/// Returns the slope of the line below all points that is nearest to them: the edge of their lower
/// convex hull over their mean time (Moon, Skelly and Towsley 1999). Requires several points,
/// sorted by time.
double slopeBelow(const std::vector<Point>& points) {
  std::vector<Point> hull;
  double middle_ns = 0.0;
  for (const Point& point : points) {
    middle_ns += point.time_ns / static_cast<double>(points.size());
    const auto above = [&](const Point& a, const Point& b) {  // b is above the line from a to point
      return (b.offset_ns - a.offset_ns) * (point.time_ns - a.time_ns) >=
             (point.offset_ns - a.offset_ns) * (b.time_ns - a.time_ns);
    };
    while (hull.size() > 1 && above(hull[hull.size() - 2], hull.back())) hull.pop_back();
    hull.push_back(point);
  }
  std::size_t i = 1;
  while (i + 1 < hull.size() && hull[i].time_ns < middle_ns) ++i;
  const Point &a = hull[i - 1], &b = hull[i];
  return (b.offset_ns - a.offset_ns) / std::max(b.time_ns - a.time_ns, 1.0);
}
}  // namespace

void ClockSync::add(LocalTime t0, MediaTime t1, MediaTime t2, LocalTime t3) {
  if (t3 < t0 || t2 < t1 || t3 - t0 < t2 - t1) return;
  const auto since = [](MediaTime there, LocalTime here) {
    return there.time_since_epoch() - here.time_since_epoch();
  };
  const Sample sample{t0 + (t3 - t0) / 2, since(t1, t0), since(t2, t3)};
  const auto later = [&](const Sample& each) { return each.time <= sample.time; };
  samples_.insert(std::find_if(samples_.rbegin(), samples_.rend(), later).base(), sample);
  if (samples_.size() > kWindow) samples_.pop_front();
  ++answered_;
  if (ready()) fit();
}

void ClockSync::fit() {
  line_ = fitLine();
  // A negative delay is impossible: the server's clock was set, and earlier samples are invalid.
  while (line_.error < Duration::zero()) {
    samples_.pop_front();
    line_ = fitLine();
    published_ = false;
  }
}

ClockSync::Line ClockSync::fitLine() const {
  Line line{samples_.back().time, samples_.back().there, 0.0, 0.0, Duration::zero()};
  std::vector<Point> there, back;
  there.reserve(samples_.size());
  back.reserve(samples_.size());
  for (const Sample& each : samples_) {
    const double time_ns = nanoseconds(each.time - line.origin);
    there.push_back({time_ns, nanoseconds(each.there - line.base)});
    back.push_back({time_ns, nanoseconds(line.base - each.back)});
  }
  if (line.origin - samples_.front().time >= kSlopeSpan)
    line.slope = std::clamp(0.5 * (slopeBelow(there) - slopeBelow(back)), -kMaxDrift, kMaxDrift);
  // The quickest ways had no queueing delay.
  double there_ns = std::numeric_limits<double>::infinity(), back_ns = there_ns;
  for (std::size_t i = 0; i < there.size(); ++i) {
    there_ns = std::min(there_ns, there[i].offset_ns - line.slope * there[i].time_ns);
    back_ns = std::min(back_ns, back[i].offset_ns + line.slope * back[i].time_ns);
  }
  line.value_ns = 0.5 * (there_ns - back_ns);
  line.error = Duration(std::llround(0.5 * (there_ns + back_ns)));
  return line;
}

Duration ClockSync::offset(LocalTime now) {
  const double ahead = line_.value_ns + line_.slope * nanoseconds(now - line_.origin);
  const Duration wanted = line_.base + Duration(std::llround(ahead));
  if (!published_) {
    published_ = true;
    offset_ = wanted;
  } else {
    const Duration drifted(
        std::llround(kMaxDrift * nanoseconds(std::max(now - last_, Duration::zero()))));
    const Duration step = drifted + std::max(error_ - line_.error, Duration::zero());
    // Leaves the range excluded by the pings at once. Within the range the change is limited by
    // clock drift and by the improvement of the estimate.
    offset_ = std::clamp(offset_, wanted - line_.error, wanted + line_.error);
    offset_ = std::clamp(wanted, offset_ - step, offset_ + step);
  }
  behind_ = std::chrono::abs(wanted - offset_);
  last_ = now;
  error_ = line_.error;
  return offset_;
}

Duration ClockSync::errorBound() const { return line_.error + behind_; }

}  // namespace hapticast
