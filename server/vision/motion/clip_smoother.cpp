// SPDX-License-Identifier: MIT
#include "server/vision/motion/clip_smoother.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/vision/motion/impact.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kFewest = 8;          // samples: a shorter track uses the window
constexpr double kSameOne_mm = 0.25;        // chosen: tolerance for poses of one frame in two runs
constexpr double kAlways_s = 1e9;           // longer than any clip
constexpr double kLeastSquare_mm2 = 1e-12;  // residue of rounding
// log10 of process noise over measurement noise, time in frames. Chosen: from a plain polynomial to
// a curve through every sample.
constexpr double kSmoothest = -9.0;
constexpr double kRoughest = 4.0;
constexpr double kRatioStep = 0.25;  // chosen: the likelihood is flat over this step

// Chosen: variances in units of a measurement's variance.
constexpr double kUnknown = 1e10;  // of the first state
constexpr double kKick = 1e8;      // of the velocity's change at an impact

constexpr int kStates = 5;  // p, v, a, jerk, snap in mm and frames
using State = Eigen::Matrix<double, kStates, 1>;
using Square = Eigen::Matrix<double, kStates, kStates>;

/// The way from one sample to the next.
struct Interval {
  Square transition = Square::Identity();
  Square noise = Square::Zero();  ///< covariance, per unit of process noise
  Square kick = Square::Zero();   ///< covariance of an impact within the interval
};

Square makeTransition(double frames) {
  Square out = Square::Identity();
  for (int row = 0; row < kStates; ++row) {
    double term = 1.0;
    for (int column = row + 1; column < kStates; ++column) {
      term *= frames / (column - row);
      out(row, column) = term;
    }
  }
  return out;
}

// Returns the integral of F g gᵀ Fᵀ for white noise on the derivative of the last state.
Square noiseOver(double frames) {
  Square out;
  constexpr double kFactorial[] = {1, 1, 2, 6, 24};
  for (int i = 0; i < kStates; ++i) {
    for (int j = 0; j < kStates; ++j) {
      const int power = 2 * kStates - 1 - i - j;
      out(i, j) = std::pow(frames, power) /
                  (power * kFactorial[kStates - 1 - i] * kFactorial[kStates - 1 - j]);
    }
  }
  return out;
}

/// One coordinate of a track.
struct Series {
  std::vector<double> value;   // relative to the first
  std::vector<bool> measured;  // same length
};

/// Result of the forward filter for one sample.
struct Filtered {
  State state;        // predicted
  Square covariance;  // of the state
  Square carry;       // transition of an error in the state to the next sample
  double surprise = 0.0;
  double variance = 1.0;
};

// Result of the forward filter for a series, with its log likelihood.
struct Forward {
  std::vector<Filtered> filtered;
  double log_likelihood = 0.0;
};

// Kalman filter; the noise's size is profiled out of the likelihood.
Forward runFilter(double ratio, const Series& series, const std::vector<Interval>& intervals) {
  const std::size_t count = series.value.size();
  Forward out;
  out.filtered.resize(count);
  State state = State::Zero();
  Square covariance = kUnknown * Square::Identity();
  double log_variances = 0.0;
  double squares = 0.0;
  int measurements = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Filtered& now = out.filtered[i];
    now = {state, covariance, Square::Identity(), 0.0, covariance(0, 0) + 1.0};
    State gain = State::Zero();
    if (series.measured[i]) {
      now.surprise = series.value[i] - state[0];
      gain = covariance.col(0) / now.variance;
      // The first measurements only determine the initial state.
      if (++measurements > kStates) {
        log_variances += std::log(now.variance);
        squares += now.surprise * now.surprise / now.variance;
      }
    }
    now.carry.col(0) -= gain;
    if (i + 1 == count) break;
    now.carry = intervals[i].transition * now.carry;
    state = intervals[i].transition * (state + gain * now.surprise);
    covariance = intervals[i].transition * covariance * now.carry.transpose() +
                 ratio * intervals[i].noise + intervals[i].kick;
    covariance = (0.5 * (covariance + covariance.transpose())).eval();
  }
  const int freedom = std::max(1, measurements - kStates);
  out.log_likelihood = -0.5 * (log_variances + freedom * std::log(squares + kLeastSquare_mm2));
  return out;
}

// Rauch-Tung-Striebel smoother in the form of de Jong (1989), which inverts no covariance.
std::vector<State> backward(const std::vector<Filtered>& filtered, const Series& series) {
  std::vector<State> out(filtered.size());
  State back = State::Zero();
  for (std::size_t i = filtered.size(); i-- > 0;) {
    const Filtered& now = filtered[i];
    back = (now.carry.transpose() * back).eval();
    if (series.measured[i]) back[0] += now.surprise / now.variance;
    out[i] = now.state + now.covariance * back;
  }
  return out;
}

std::vector<State> runSmoother(const Series& series, const std::vector<Interval>& intervals) {
  Forward best;
  best.log_likelihood = -std::numeric_limits<double>::infinity();
  for (double exponent = kSmoothest; exponent <= kRoughest; exponent += kRatioStep) {
    Forward now = runFilter(std::pow(10.0, exponent), series, intervals);
    if (now.log_likelihood > best.log_likelihood) best = std::move(now);
  }
  return backward(best.filtered, series);
}

template <class Value>
Series makeSeries(const std::vector<Sample>& samples, bool depth, Value value) {
  Series out;
  const double base = value(samples.front());
  for (const Sample& sample : samples) {
    out.value.push_back(value(sample) - base);
    out.measured.push_back(sample.seen && (!depth || sample.depth_seen));
  }
  return out;
}

std::vector<Interval> splitAtImpacts(const std::vector<Sample>& samples,
                                     const std::vector<Impact>& impacts, double interval_s) {
  std::vector<Interval> out;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const double from_s = samples[i].time_s;
    const double frames = std::max(1e-3, (samples[i + 1].time_s - from_s) / interval_s);
    out.push_back({makeTransition(frames), noiseOver(frames), Square::Zero()});
    for (const Impact& impact : impacts) {
      const double at = (toSeconds(impact.time) - from_s) / interval_s;
      if (!(at >= 0 && at < frames)) continue;
      const State kick = makeTransition(frames - at).col(1);
      out.back().kick = kKick * kick * kick.transpose();
    }
  }
  return out;
}

std::vector<Impact> findImpacts(const std::vector<Sample>& samples) {
  std::vector<Impact> out;
  ImpactFinder finder;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    finder.test(samples, i);
    for (const Impact& impact : finder.findAround(samples[i].time_s, kAlways_s)) {
      if (out.empty() || impact.time > out.back().time) out.push_back(impact);
    }
  }
  return out;
}

bool isResting(const std::vector<Sample>& samples, std::size_t at, std::size_t reach) {
  const std::size_t first = at > reach ? at - reach : 0;
  const std::size_t last = std::min(samples.size() - 1, at + reach);
  for (std::size_t i = first; i <= last; ++i) {
    if (samples[i].position_mm != samples[at].position_mm ||
        samples[i].angle_rad != samples[at].angle_rad)
      return false;
  }
  return true;
}

}  // namespace

std::vector<Motion> smoothTrack(const std::vector<Sample>& samples,
                                const std::vector<Impact>& impacts, int lookahead) {
  std::vector<Motion> out(samples.size());
  if (samples.size() < kFewest) {
    for (std::size_t i = 0; i < samples.size(); ++i) out[i] = computeMotion(samples, i, lookahead);
    return out;
  }
  const double interval_s =
      (samples.back().time_s - samples.front().time_s) / double(samples.size() - 1);
  const std::vector<Interval> intervals = splitAtImpacts(samples, impacts, interval_s);
  const auto each = [&](const Series& series, const auto& take) {
    const std::vector<State> states = runSmoother(series, intervals);
    for (std::size_t i = 0; i < states.size(); ++i) take(out[i], states[i]);
  };
  const bool pans = !compensatePan(samples).empty();
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = [axis](const Sample& s) { return s.position_mm[axis]; };
    each(makeSeries(samples, axis == 2, value), [&](Motion& motion, const State& x) {
      motion.position_mm[axis] = value(samples.front()) + x[0];
      motion.velocity_mm_s[axis] = x[1] / interval_s;
      motion.acceleration_mm_s2[axis] = x[2] / (interval_s * interval_s);
    });
    if (!pans || axis == 2) continue;
    each(
        makeSeries(samples, false, [axis](const Sample& s) { return s.panCompensated_mm()[axis]; }),
        [&](Motion& motion, const State& x) {
          motion.acceleration_mm_s2[axis] = x[2] / (interval_s * interval_s);
        });
  }
  each(makeSeries(samples, false, [](const Sample& s) { return s.angle_rad; }),
       [&](Motion& motion, const State& x) {
         motion.angle_rad = samples.front().angle_rad + x[0];
         motion.angular_velocity_rad_s = x[1] / interval_s;
       });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (isResting(samples, i, std::size_t(lookahead)))
      out[i] = computeMotion(samples, i, lookahead);
  }
  return out;
}

void ClipMotion::add(std::uint32_t id, std::uint64_t frame, double time_s, const ObjectPose& pose,
                     bool well) {
  entries_[id].push_back({frame, time_s, pose, well});
}

void ClipMotion::smooth(const NominalFrame& nominal, int lookahead, bool ended) {
  for (const auto& [id, entries] : entries_) {
    Track& track = tracks_[id];
    std::vector<Sample> samples;
    for (const Entry& entry : entries) {
      samples.push_back(nominal.sample(entry.pose, entry.time_s));
      samples.back().seen = samples.back().seen && entry.well_tracked;
    }
    track.impacts = findImpacts(samples);
    const std::vector<Motion> motions = smoothTrack(samples, track.impacts, lookahead);
    const std::size_t open = ended ? 0 : std::min(samples.size(), std::size_t(lookahead));
    for (std::size_t i = 0; i + open < samples.size(); ++i) {
      if (entries[i].well_tracked)
        track.moments[entries[i].frame] = {motions[i], samples[i].position_mm, samples[i].time_s};
    }
  }
  entries_.clear();
}

const ClipMotion::Moment* ClipMotion::at(std::uint32_t object, std::uint64_t frame,
                                         const Vec3& measured_mm) const {
  const auto track = tracks_.find(object);
  if (track == tracks_.end()) return nullptr;
  const auto moment = track->second.moments.find(frame);
  if (moment == track->second.moments.end()) return nullptr;
  const bool same = (moment->second.measured_mm - measured_mm).norm() < kSameOne_mm;
  return same ? &moment->second : nullptr;
}

std::vector<Impact> ClipMotion::findImpactsAround(std::uint32_t object, double time_s,
                                                  double reach_s) const {
  const auto track = tracks_.find(object);
  if (track == tracks_.end()) return {};
  std::vector<Impact> out = track->second.impacts;
  std::erase_if(out, [&](const Impact& impact) {
    return std::abs(toSeconds(impact.time) - time_s) > reach_s;
  });
  return out;
}

std::vector<double> ClipMotion::accelerations_mm_s2(double reach_s) const {
  std::vector<double> out;
  for (const auto& [object, track] : tracks_) {
    for (const auto& [frame, moment] : track.moments) {
      if (findImpactsAround(object, moment.time_s, reach_s).empty())
        out.push_back(moment.motion.acceleration_mm_s2.norm());
    }
  }
  return out;
}

}  // namespace hapticast::server
