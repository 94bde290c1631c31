// SPDX-License-Identifier: MIT
// -m_cursor a_cursor: how much virtual inertia each estimator of the acceleration can carry, its
// noise at rest and its error in a hand's motion.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

/// m/s² from counted positions in mm, one a tick.
class Estimator {
 public:
  virtual ~Estimator() = default;
  /// What was sent to the device since the last one.
  virtual void sent(double /*force_N*/, double /*wall_N_mm*/) {}
  virtual double next(double position_mm) = 0;
};

/// Double difference and n one-poles.
class Difference final : public Estimator {
 public:
  Difference(int poles, double cut_Hz)
      : poles_(poles), share_(1.0 - std::exp(-2.0 * std::numbers::pi * cut_Hz * 1e-3)) {}
  double next(double x) override {
    if (first_) last_ = before_ = x;
    first_ = false;
    double a = (x - 2.0 * last_ + before_) * 1e3;
    before_ = last_;
    last_ = x;
    for (int i = 0; i < poles_; ++i) a = smooth_[i] += share_ * (a - smooth_[i]);
    return a;
  }

 private:
  int poles_;
  double share_;
  bool first_ = true;
  double last_ = 0.0, before_ = 0.0;
  double smooth_[2] = {};
};

/// Quadratic through the last n positions, at its newest point.
class SavitzkyGolay final : public Estimator {
 public:
  explicit SavitzkyGolay(int n) : window_(static_cast<std::size_t>(n)) {}
  double next(double x) override {
    if (!full_) std::fill(window_.begin(), window_.end(), x);
    full_ = true;
    std::rotate(window_.begin(), window_.begin() + 1, window_.end());
    window_.back() = x;
    // The curvature of a least-squares parabola: the projection on t² - mean.
    const double n = double(window_.size());
    const double mean = (n * n - 1.0) / 12.0;
    double along = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < window_.size(); ++i) {
      const double t = double(i) - 0.5 * (n - 1.0);
      const double p = t * t - mean;
      along += p * window_[i];
      square += p * p;
    }
    return 2.0 * along / square * 1e3;
  }

 private:
  std::vector<double> window_;
  bool full_ = false;
};

/// Constant-acceleration Kalman filter of a jerk density (its fixed gains by iteration).
class Kalman final : public Estimator {
 public:
  explicit Kalman(double jerk_density) {
    Eigen::Matrix3d f;
    const double t = 1e-3;
    f << 1, t, t * t / 2, 0, 1, t, 0, 0, 1;
    Eigen::Matrix3d q;
    q << std::pow(t, 5) / 20, std::pow(t, 4) / 8, std::pow(t, 3) / 6, std::pow(t, 4) / 8,
        std::pow(t, 3) / 3, t * t / 2, std::pow(t, 3) / 6, t * t / 2, t;
    q *= jerk_density;
    Eigen::Matrix3d p = q;
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Matrix3d predicted = f * p * f.transpose() + q;
      gain_ = predicted.col(0) / (predicted(0, 0) + 55e-6 * 55e-6 / 12.0);
      p = predicted - gain_ * predicted.row(0);
    }
    step_ = f;
  }
  double next(double position_mm) override {
    const double x = position_mm * 1e-3;
    if (first_) state_ = {x, 0.0, 0.0};
    first_ = false;
    state_ = step_ * state_;
    state_ += gain_ * (x - state_[0]);
    return state_[2];
  }

 private:
  Eigen::Matrix3d step_;
  Vec3 gain_;
  Vec3 state_ = Vec3::Zero();
  bool first_ = true;
};

/// As in the renderer.
class Product final : public Estimator {
 public:
  explicit Product(int delay) { motion_.setDelay(delay); }
  void sent(double force_N, double wall_N_mm) override {
    motion_.sent({0.0, 0.0, force_N}, wall_N_mm);
  }
  double next(double position_mm) override {
    DeviceState state;
    state.position_mm = {0.0, 0.0, position_mm};
    state.time = localTime(1.0) + Duration(1'000'000) * ++ticks_;
    return motion_.update(state).acceleration_m_s2.z();
  }

 private:
  HipEstimator motion_{DeviceProfile{}};
  std::int64_t ticks_ = 0;
};

struct Named {
  const char* name;
  std::function<std::unique_ptr<Estimator>(int delay)> make;
  bool is_default = false;
};

template <class T, class... Arguments>
std::function<std::unique_ptr<Estimator>(int)> maker(Arguments... arguments) {
  return [=](int) { return std::make_unique<T>(arguments...); };
}

std::vector<Named> estimators() {
  return {{"double difference", maker<Difference>(0, 1.0)},
          {"+ 2 poles 50 Hz", maker<Difference>(2, 50.0)},
          {"+ 2 poles 20 Hz", maker<Difference>(2, 20.0)},
          {"observer, 2 x 20 Hz (the room's)",
           [](int delay) { return std::make_unique<Product>(delay); }, true},
          {"SG n = 15", maker<SavitzkyGolay>(15)},
          {"SG n = 31", maker<SavitzkyGolay>(31)},
          {"Kalman 1e2", maker<Kalman>(1e2)},
          {"Kalman 1e4", maker<Kalman>(1e4)},
          {"Kalman 1e6", maker<Kalman>(1e6)}};
}

/// The linear loop that theory speaks of: a wall on both sides, no counts, no clamp. Does its
/// motion shrink?
bool stable(const Named& what, double mass_ratio, double stiffness_N_mm, int delay,
            const Hand& hand) {
  PlantProfile profile = omni(stiffness_N_mm, delay);
  AxisPlant plant(profile, hand);
  HipEstimator motion(profile);
  const auto estimator = what.make(delay);
  const double k = std::min(stiffness_N_mm, stiffnessLimit_N_mm(profile));
  const double damping_Ns_m = wallDamping_Ns_m(k, kOmniMass_kg, stiffnessLimit_N_mm(profile));
  plant.reset(1e-3, 0.0);
  double sent_N[8] = {};
  double early = 0.0;
  double late = 0.0;
  constexpr int kTicks = 3000;
  for (int i = 0; i < kTicks; ++i) {
    const double x_mm = plant.position_m() * 1e3;
    DeviceState state;
    state.position_mm = {0.0, 0.0, x_mm};
    state.time = localTime(1.0) + Duration(1'000'000) * i;
    motion.sent({0.0, 0.0, sent_N[0]}, k);
    estimator->sent(sent_N[0], k);
    const HipState& ahead = motion.update(state).ahead;
    const double force_N = -k * ahead.position_mm.z() -
                           damping_Ns_m * 1e-3 * ahead.velocity_mm_s.z() -
                           mass_ratio * kOmniMass_kg * estimator->next(x_mm);
    for (int j = 7; j > 0; --j) sent_N[j] = sent_N[j - 1];
    sent_N[0] = force_N;
    plant.advance(sent_N[delay], 0.0, 0.0);
    if (!(std::abs(x_mm) < 1e4)) return false;
    if (i >= 1000 && i < 1500) early += x_mm * x_mm;
    if (i >= kTicks - 500) late += x_mm * x_mm;
  }
  return late <= early || late < 1e-12;
}

/// The smallest ratio at which it is lost (10: beyond the scan).
double largestRatio(const Named& what, double stiffness_N_mm, int delay, const Hand& hand) {
  double last = 0.2;
  for (double ratio = 0.2; ratio <= 8.0; ratio *= 1.06) {
    if (!stable(what, ratio, stiffness_N_mm, delay, hand)) return last;
    last = ratio;
  }
  return 10.0;
}

/// rms of m a at rest somewhere between two counts with a tremor of a few micrometres.
double noise_N(const Named& what) {
  const auto estimator = what.make(0);
  double square = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const double x_mm = 0.0275 + 0.01 * std::sin(0.0628 * i) + 0.004 * std::sin(1.7 * i);
    const double a = estimator->next(std::round(x_mm / 0.055) * 0.055);
    if (i >= 1000) square += a * a / 9000.0;
  }
  return kOmniMass_kg * std::sqrt(square);
}

/// rms error of m a in a hand's motion of 2 Hz, 30 mm.
double error_N(const Named& what) {
  const auto estimator = what.make(0);
  const double w = 4.0 * std::numbers::pi;
  double square = 0.0;
  for (int i = 0; i < 10'000; ++i) {
    const double x_mm = 30.0 * std::sin(w * i * 1e-3);
    const double a = estimator->next(std::round(x_mm / 0.055) * 0.055);
    const double truth = -w * w * x_mm * 1e-3;
    if (i >= 1000) square += (a - truth) * (a - truth) / 9000.0;
  }
  return kOmniMass_kg * std::sqrt(square);
}

}  // namespace

void stabilityInertia(const StabilityReport& to) {
  struct Cell {
    const Named* what;
    double stiffness_N_mm;
    int delay;
    const NamedHand* hand;
    double ratio = 0.0;
  };
  const std::vector<Named> all = estimators();
  std::vector<Cell> cells;
  for (const Named& what : all) {
    for (const double k : {1.0, 5.0}) {
      for (const NamedHand* hand : {&kHands[4], &kHands[1], &kHands[3]}) {
        for (const int d : {0, 1, 2}) cells.push_back({&what, k, d, hand});
      }
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) {
    Cell& c = cells[i];
    c.ratio = largestRatio(*c.what, c.stiffness_N_mm, c.delay, c.hand->hand);
  });
  double margin = 1e9;
  for (const Cell& c : cells) {
    to.report.add({text("K %g %s d %d", c.stiffness_N_mm, c.hand->name, c.delay), "inertia_margin",
                   c.what->name, c.ratio, "m_cursor/m", 0.0, c.what->is_default});
    if (c.what->is_default) margin = std::min(margin, c.ratio);
  }
  for (const Named& what : all) {
    const double noise = noise_N(what);
    const double error = error_N(what);
    to.report.add({"at rest", "inertia_force", what.name, noise, "N rms", 0.0, what.is_default});
    to.report.add(
        {"2 Hz 30 mm: error", "inertia_force", what.name, error, "N rms", 0.0, what.is_default});
    if (!what.is_default) continue;
    to.report.require("inertia term, the room's filter: noise at rest", "<= 0.015 N (aim 0.01)",
                      text("%.4f N", noise), noise <= 0.015);
    to.report.require("inertia term: error at 2 Hz, 30 mm", "<= 0.04 N (aim 0.03)",
                      text("%.4f N", error), error <= 0.04);
  }
  to.report.require(
      "inertia term: largest stable m_cursor over the device's mass, K 1 and K_max, d 0-2, no "
      "hand and grips",
      ">= 3", text("%.1f", margin), margin >= 3.0);
}

}  // namespace hapticast::evaluate
