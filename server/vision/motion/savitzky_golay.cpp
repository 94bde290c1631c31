// SPDX-License-Identifier: MIT
#include "server/vision/motion/savitzky_golay.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/least_squares.hpp"

namespace hapticast::server {

namespace {

constexpr double kLookahead_s = 0.085;  // measured: 80 to 120 ms suffice; 3 frames at 25 fps
constexpr double kCurvature = 0.02;  // chosen: weight of a part's curvature relative to its misfit
constexpr double kMisfit_mm =
    0.12;  // chosen: a window that fits no better than this has a bounce in it

struct Polynomial {
  Eigen::VectorXd c;        // of (t - t0) / h
  double square_sum = 0.0;  // of the residuals
  int freedom = 0;          // samples minus coefficients
};

template <class Value>
Polynomial fit(const std::vector<Sample>& samples, std::size_t first, std::size_t last,
               std::size_t at, double h_s, int order, bool depth, Value value) {
  std::vector<const Sample*> used;
  for (std::size_t i = first; i <= last; ++i) {
    if (samples[i].seen && (!depth || samples[i].depth_seen)) used.push_back(&samples[i]);
  }
  const int count = static_cast<int>(used.size());
  Polynomial out;
  if (count == 0) {
    out.c = Eigen::VectorXd::Constant(1, value(samples[at]));
    return out;
  }
  order = std::min(order, count - 1);
  const double base = value(*used.front());  // offset, so that samples at rest yield exactly 0
  Eigen::MatrixXd powers(count, order + 1);
  Eigen::VectorXd right(count);
  for (int i = 0; i < count; ++i) {
    const Sample& sample = *used[static_cast<std::size_t>(i)];
    const double tau = (sample.time_s - samples[at].time_s) / h_s;
    for (int k = 0; k <= order; ++k) powers(i, k) = std::pow(tau, k);
    right[i] = value(sample) - base;
  }
  out.c = solveLeastSquares(powers, right);
  out.square_sum = (powers * out.c - right).squaredNorm();
  out.freedom = count - order - 1;
  out.c[0] += base;
  return out;
}

struct WindowFit {
  std::array<Polynomial, 4> axes;  // x, y, z, angle

  [[nodiscard]] double misfit_mm() const {
    double sum = 0;
    int freedom = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      sum += axes[i].square_sum;
      freedom = std::max(freedom, axes[i].freedom);
    }
    return freedom > 0 ? std::sqrt(sum / freedom) : std::numeric_limits<double>::infinity();
  }
  // Returns the change of the step between samples.
  [[nodiscard]] double curvature_mm() const {
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i)
      square += axes[i].c.size() > 2 ? 4 * axes[i].c[2] * axes[i].c[2] : 0.0;
    return std::sqrt(square);
  }
};

// Returns the polynomial order that `count` samples support.
int chooseOrder(std::size_t count, bool centred) {
  if (count >= 7 && centred) return 4;
  if (count >= 4 || (count == 3 && centred)) return 2;
  return count >= 2 ? 1 : 0;
}

WindowFit fitWindow(const std::vector<Sample>& samples, std::size_t first, std::size_t last,
                    std::size_t at, double h_s, int order) {
  WindowFit out;
  for (int axis = 0; axis < 3; ++axis) {
    out.axes[static_cast<std::size_t>(axis)] =
        fit(samples, first, last, at, h_s, order, axis == 2,
            [axis](const Sample& s) { return s.position_mm[axis]; });
  }
  out.axes[3] =
      fit(samples, first, last, at, h_s, order, false, [](const Sample& s) { return s.angle_rad; });
  return out;
}

double coefficient(const Polynomial& p, Eigen::Index k) { return k < p.c.size() ? p.c[k] : 0.0; }

}  // namespace

int lookaheadFrames(double fps) {
  return std::clamp(static_cast<int>(std::lround(kLookahead_s * fps)), 3, 20);
}

std::vector<Sample> compensatePan(const std::vector<Sample>& samples) {
  const auto moved = [&](const Sample& s) {
    return s.background_mm != samples.front().background_mm;
  };
  if (std::none_of(samples.begin(), samples.end(), moved)) return {};
  std::vector<Sample> out = samples;
  for (Sample& sample : out) {
    sample.position_mm = sample.panCompensated_mm();
    sample.background_mm.setZero();
  }
  return out;
}

Motion computeMotion(const std::vector<Sample>& samples, std::size_t at, int lookahead) {
  const auto reach = static_cast<std::size_t>(lookahead);
  const std::size_t first = at > reach ? at - reach : 0;
  const std::size_t last = std::min(samples.size() - 1, at + reach);
  const std::size_t count = last - first + 1;
  const double span_s = samples[last].time_s - samples[first].time_s;
  const double h_s = count > 1 && span_s > 0 ? span_s / double(count - 1) : 1.0;
  const bool centred = at - first == reach && last - at == reach;
  WindowFit best = fitWindow(samples, first, last, at, h_s, chooseOrder(count, centred));
  if (count >= 6 && best.misfit_mm() > kMisfit_mm) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t from = first; from <= at; ++from) {
      for (std::size_t to = std::max(at, from + 3); to <= last; ++to) {
        const WindowFit part = fitWindow(samples, from, to, at, h_s, 2);
        // Longer windows win unless a shorter one fits far better. Four samples across a bounce may
        // fit a parabola by chance, but with far more curvature than their neighbours.
        const double misfit = part.misfit_mm() * (1 + 0.5 * double(count - (to - from + 1))) +
                              kCurvature * part.curvature_mm();
        if (misfit < least) {
          least = misfit;
          best = part;
        }
      }
    }
  }
  Motion out;
  for (int axis = 0; axis < 3; ++axis) {
    const Polynomial& p = best.axes[static_cast<std::size_t>(axis)];
    out.position_mm[axis] = coefficient(p, 0);
    out.velocity_mm_s[axis] = coefficient(p, 1) / h_s;
    out.acceleration_mm_s2[axis] = 2 * coefficient(p, 2) / (h_s * h_s);
  }
  out.angle_rad = coefficient(best.axes[3], 0);
  out.angular_velocity_rad_s = coefficient(best.axes[3], 1) / h_s;
  if (const std::vector<Sample> steady = compensatePan(samples); !steady.empty())
    out.acceleration_mm_s2 = computeMotion(steady, at, lookahead).acceleration_mm_s2;
  return out;
}

}  // namespace hapticast::server
