// SPDX-License-Identifier: MIT
#include "server/vision/motion/impact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kRemembered = 50;  // chosen: two seconds of frames show the usual jump
// Of the median jump; measured: no false impacts on smooth clips.
constexpr double kAboveUsual = 6.0;
constexpr double kSmallest_mm_s = 60.0;  // chosen: a weaker pulse is not perceptible
// Tuned with bounces at any instant between frames, with and without noise (impact_test).
constexpr double kBend = 0.3;    // change of acceleration over a frame, relative to the jump
constexpr double kMiss = 0.2;    // gap between the parabolas, relative to the jump over a frame
constexpr double kBeside = 0.1;  // frames that noise may shift an impact beyond its interval
constexpr double kLate = 0.85;   // from this place on, the next interval may be the true one
constexpr double kUneven = 2.5;  // longest over shortest interval that a parabola may span

struct Parabola {  // polynomial of the time since an instant
  Vec3 c0, c1, c2;
};

// Interpolates three samples by Newton's divided differences.
Parabola fitParabola(const Sample* s, double from_s) {
  const std::array<double, 3> t{s[0].time_s - from_s, s[1].time_s - from_s, s[2].time_s - from_s};
  const std::array<Vec3, 3> p{s[0].panCompensated_mm(), s[1].panCompensated_mm(),
                              s[2].panCompensated_mm()};
  const Vec3 first = (p[1] - p[0]) / (t[1] - t[0]);
  const Vec3 second = ((p[2] - p[1]) / (t[2] - t[1]) - first) / (t[2] - t[0]);
  return {p[0] - first * t[0] + second * (t[0] * t[1]), first - second * (t[0] + t[1]), second};
}

// Returns the root of a + b t + c t² nearest to `near`; nullopt if there is none.
std::optional<double> findRootNear(double a, double b, double c, double near) {
  const double square = b * b - 4 * a * c;
  if (square < 0) return std::nullopt;
  const double q = -0.5 * (b + std::copysign(std::sqrt(square), b));
  const double one = c != 0 ? q / c : std::numeric_limits<double>::infinity();
  const double two = q != 0 ? a / q : std::numeric_limits<double>::infinity();
  const double best = std::abs(one - near) < std::abs(two - near) ? one : two;
  return std::isfinite(best) ? std::optional(best) : std::nullopt;
}

bool areEvenlySpaced(const Sample* s, std::size_t count) {
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0;
  for (std::size_t i = 1; i < count; ++i) {
    shortest = std::min(shortest, s[i].time_s - s[i - 1].time_s);
    longest = std::max(longest, s[i].time_s - s[i - 1].time_s);
  }
  return shortest > 0 && longest < kUneven * shortest;
}

}  // namespace

std::optional<ImpactFinder::Jump> ImpactFinder::jumpAfter(const std::vector<Sample>& samples,
                                                          std::size_t at) {
  if (at + 1 < kSide || at + kSide >= samples.size()) return std::nullopt;
  const Sample* first = &samples[at + 1 - kSide];
  const bool measured =
      std::all_of(first, first + 2 * kSide, [](const Sample& s) { return s.seen && s.confident; });
  if (!measured || !areEvenlySpaced(first, 2 * kSide)) return std::nullopt;
  const double from_s = samples[at].time_s;
  const double step_s = samples[at + 1].time_s - from_s;
  const Parabola left = fitParabola(first, from_s);
  const Parabola right = fitParabola(first + kSide, from_s);
  Parabola off{right.c0 - left.c0, right.c1 - left.c1, right.c2 - left.c2};
  const bool depth_seen =
      std::all_of(first, first + 2 * kSide, [](const Sample& s) { return s.depth_seen; });
  if (!depth_seen) off.c0.z() = off.c1.z() = off.c2.z() = 0;
  const Vec3 middle = off.c1 + off.c2 * step_s;
  Jump out;
  out.middle_mm_s = middle.norm();
  if (!(out.middle_mm_s > 0)) return out;
  const Vec3 along = middle / out.middle_mm_s;
  const auto meet_s =
      findRootNear(along.dot(off.c0), along.dot(off.c1), along.dot(off.c2), 0.5 * step_s);
  if (!meet_s) return out;
  out.place = *meet_s / step_s;
  // Strictly between the two frames, where the client's interpolation searches for it.
  const double inside_s = std::clamp(out.place, 1e-3, 1 - 1e-3) * step_s;
  out.time_s = from_s + inside_s;
  out.delta_mm_s = off.c1 + 2 * off.c2 * inside_s;
  const double jump = out.delta_mm_s.norm();
  const Vec3 miss = off.c0 + off.c1 * inside_s + off.c2 * (inside_s * inside_s);
  out.bend = 2 * off.c2.norm() * step_s / jump;
  out.clean = out.place > -kBeside && out.place < 1 + kBeside && out.bend < kBend &&
              miss.norm() < kMiss * jump * step_s;
  return out;
}

bool ImpactFinder::exceedsNoise(const Jump& jump) const {
  std::vector<double> usual(usual_mm_s_.begin(), usual_mm_s_.end());
  return jump.delta_mm_s.norm() > std::max(kSmallest_mm_s, kAboveUsual * computeMedian(usual));
}

void ImpactFinder::accept(const Jump& jump) {
  found_.push_back({mediaTime(jump.time_s), jump.delta_mm_s});
  if (found_.size() > kMaxImpacts) found_.pop_front();
}

// A bounce also disturbs the neighbour intervals: their parabolas cross it, bend, and meet at the
// frame between. So an impact late in its interval waits for the next interval. The straighter of
// the two wins, and an impact right after another one is a duplicate.
void ImpactFinder::test(const std::vector<Sample>& samples, std::size_t at) {
  const std::optional<Jump> jump = jumpAfter(samples, at);
  const std::optional<Jump> waiting = std::exchange(waiting_, std::nullopt);
  const bool is_one = jump && jump->clean && exceedsNoise(*jump);
  if (jump) {
    usual_mm_s_.push_back(jump->middle_mm_s);
    if (usual_mm_s_.size() > kRemembered) usual_mm_s_.pop_front();
  }
  if (!is_one) {
    if (waiting) accept(*waiting);
    return;
  }
  const double step_s = samples[at + 1].time_s - samples[at].time_s;
  const bool again = !found_.empty() && jump->time_s - toSeconds(found_.back().time) < 1.5 * step_s;
  if (again) return;
  if (waiting) {
    accept(waiting->bend < jump->bend ? *waiting : *jump);
  } else if (jump->place > kLate) {
    waiting_ = jump;
  } else {
    accept(*jump);
  }
}

std::vector<Impact> ImpactFinder::findAround(double time_s, double reach_s) const {
  std::vector<Impact> out;
  for (const Impact& impact : found_) {
    if (std::abs(toSeconds(impact.time) - time_s) <= reach_s) out.push_back(impact);
  }
  return out;
}

}  // namespace hapticast::server
