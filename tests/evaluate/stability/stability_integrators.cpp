// SPDX-License-Identifier: MIT
// Integrators of the virtual device: error against run time, and the stiffness at which each breaks
// or hides the truth. The product has the exact one only; the others live here.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <sstream>

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

constexpr double kDamping_Ns_m = 0.2;

struct State {
  double x_m = 0.0, v_m_s = 0.0;
};

/// Coulomb friction as everybody smooths it.
double acceleration(const State& s, double force_N, double friction_N) {
  const double rub_N = friction_N > 0.0 ? friction_N * std::tanh(s.v_m_s / 1e-3) : 0.0;
  return (force_N - kDamping_Ns_m * s.v_m_s - rub_N) / kOmniMass_kg;
}

State explicitEuler(const State& s, double force_N, double friction_N, double t) {
  return {s.x_m + t * s.v_m_s, s.v_m_s + t * acceleration(s, force_N, friction_N)};
}
State semiImplicitEuler(const State& s, double force_N, double friction_N, double t) {
  const double v = s.v_m_s + t * acceleration(s, force_N, friction_N);
  return {s.x_m + t * v, v};
}
State secondOrder(const State& s, double force_N, double friction_N, double t) {
  const double a = acceleration(s, force_N, friction_N);
  return {s.x_m + t * s.v_m_s + 0.5 * t * t * a, s.v_m_s + t * a};
}
State rungeKutta4(const State& s, double force_N, double friction_N, double t) {
  const auto a = [&](double x, double v) { return acceleration({x, v}, force_N, friction_N); };
  const double a1 = a(s.x_m, s.v_m_s);
  const double v2 = s.v_m_s + 0.5 * t * a1;
  const double a2 = a(s.x_m, v2);
  const double v3 = s.v_m_s + 0.5 * t * a2;
  const double a3 = a(s.x_m, v3);
  const double v4 = s.v_m_s + t * a3;
  const double a4 = a(s.x_m, v4);
  return {s.x_m + t / 6.0 * (s.v_m_s + 2.0 * v2 + 2.0 * v3 + v4),
          s.v_m_s + t / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)};
}

using Step = State (*)(const State&, double, double, double);

/// Moves on by a tick under a held force.
class Plant {
 public:
  explicit Plant(Step step, double friction_N) : step_(step), friction_N_(friction_N) {
    client::PlantProfile profile;
    profile.mass_kg = kOmniMass_kg;
    profile.damping_Ns_m = kDamping_Ns_m;
    profile.friction_N = friction_N;
    exact_ = std::make_unique<AxisPlant>(profile, Hand::none());
  }
  void reset(const State& s) {
    state_ = s;
    exact_->reset(s.x_m, s.v_m_s);
  }
  void advance(double force_N) {
    if (step_ != nullptr) {
      state_ = step_(state_, force_N, friction_N_, 1e-3);
      return;
    }
    exact_->advance(force_N, 0.0, 0.0);
    state_ = {exact_->position_m(), exact_->velocity_m_s()};
  }
  [[nodiscard]] const State& state() const { return state_; }

 private:
  Step step_;  // null: the device's own
  double friction_N_;
  std::unique_ptr<AxisPlant> exact_;
  State state_;
};

/// The truth: 500 sub-steps of the second order a tick, sticking where friction holds.
class Truth {
 public:
  explicit Truth(double friction_N) : friction_N_(friction_N) {}
  void reset(const State& s) { s_ = s; }
  void advance(double force_N) {
    constexpr int kSteps = 500;
    constexpr double t = 1e-3 / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      if (s_.v_m_s == 0.0 && std::abs(force_N) <= friction_N_) continue;
      const double way = s_.v_m_s != 0.0 ? s_.v_m_s : force_N;
      const double rub_N = std::copysign(friction_N_, way);
      // Exact for the held force within the sub-step, without differences of large numbers.
      const double rate = kDamping_Ns_m / kOmniMass_kg;
      const double a = (force_N - rub_N - kDamping_Ns_m * s_.v_m_s) / kOmniMass_kg;
      const double v = s_.v_m_s - a * std::expm1(-rate * t) / rate;
      if (friction_N_ > 0.0 && s_.v_m_s != 0.0 && v * s_.v_m_s < 0.0) {
        const double part = s_.v_m_s / (s_.v_m_s - v);
        s_ = {s_.x_m + 0.5 * part * t * s_.v_m_s, 0.0};
        continue;
      }
      const double half = 0.5 * t * t * (1.0 - rate * t / 3.0 * (1.0 - rate * t / 4.0));
      s_ = {s_.x_m + s_.v_m_s * t + a * half, v};
    }
  }
  [[nodiscard]] const State& state() const { return s_; }

 private:
  double friction_N_;
  State s_;
};

/// A wall damped like the chain's at no delay, pushed with 0.5 N: errors do not multiply from
/// bounce to bounce.
double wall_N(double stiffness_N_mm, const State& s) {
  const double k = stiffness_N_mm * 1e3;
  return (s.x_m < 0.0 ? std::max(0.0, -k * (s.x_m + wallLead_s(0) * s.v_m_s)) : 0.0) - 0.5;
}

/// Position error in mm (rms) over a second of bouncing.
double error_mm(Step step, double stiffness_N_mm, double friction_N) {
  Truth truth(friction_N);
  Plant plant(step, friction_N);
  truth.reset({5e-3, -0.1});
  plant.reset({5e-3, -0.1});
  double square = 0.0;
  for (int i = 0; i < 1000; ++i) {
    truth.advance(wall_N(stiffness_N_mm, truth.state()));
    plant.advance(wall_N(stiffness_N_mm, plant.state()));
    const double off_mm = (plant.state().x_m - truth.state().x_m) * 1e3;
    square += off_mm * off_mm / 1000.0;
    if (!(square < 1e12)) return 1e6;
  }
  return std::sqrt(square);
}

/// Critical stiffness of a bilateral spring K x + K tau v, N/m.
double breakdown_N_m(Step step, double lead_s) {
  const auto shrinks = [&](double k) {
    Plant plant(step, 0.0);
    plant.reset({1e-3, 0.0});
    double early = 0.0;
    double late = 0.0;
    for (int i = 0; i < 8000; ++i) {
      const State& s = plant.state();
      plant.advance(-k * (s.x_m + lead_s * s.v_m_s));
      const double energy = k * s.x_m * s.x_m + kOmniMass_kg * s.v_m_s * s.v_m_s;
      if (!(energy < 1e6)) return false;
      if (i >= 2000 && i < 3000) early += energy;
      if (i >= 7000) late += energy;
    }
    return late < early || late < 1e-30;
  };
  double low = 1.0;
  double high = 1e6;
  for (int i = 0; i < 30; ++i) {
    const double middle = std::sqrt(low * high);
    (shrinks(middle) ? low : high) = middle;
  }
  return low;
}

double time_ns(Step step, double friction_N) {
  Plant plant(step, friction_N);
  double best_ns = 1e9;
  for (int round = 0; round < 5; ++round) {
    plant.reset({5e-3, -0.1});
    const auto begin = std::chrono::steady_clock::now();
    constexpr int kTicks = 100'000;
    for (int i = 0; i < kTicks; ++i) plant.advance(std::max(0.0, -500.0 * plant.state().x_m) - 0.5);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    best_ns = std::min(best_ns, took.count() / kTicks);
  }
  return best_ns;
}

struct Integrator {
  const char* name;
  Step step;
};
constexpr Integrator kIntegrators[] = {{"explicit Euler", explicitEuler},
                                       {"semi-implicit Euler", semiImplicitEuler},
                                       {"2nd-order position", secondOrder},
                                       {"RK4", rungeKutta4},
                                       {"exact with stick (the device's)", nullptr}};

struct Found {
  double plain_mm, rubbed_mm, plain_ns, rubbed_ns;
};

void plot(const StabilityReport& to, const std::vector<Found>& found) {
  std::ostringstream out;
  out << "set terminal pngcairo noenhanced size 1100,460 font 'sans,11'\nset output "
         "'stability_integrators.png'\nset multiplot layout 1,2\nset logscale xy\nset grid lc rgb "
         "'#d0d0d0'\nset key inside right bottom vertical font ',10'\nset xlabel 'run time, ns a "
         "step'\nset ylabel 'rms position error, mm'\nset format y '10^{%L}'\nset xrange "
         "[5:1000]\nset yrange [1e-14:100]\nset termoption enhanced\n";
  for (std::size_t i = 0; i < found.size(); ++i) {
    out << "$plain" << i << " << EOD\n"
        << found[i].plain_ns << ' ' << std::max(1e-14, found[i].plain_mm) << "\nEOD\n$rubbed" << i
        << " << EOD\n"
        << found[i].rubbed_ns << ' ' << std::max(1e-14, found[i].rubbed_mm) << "\nEOD\n";
  }
  for (const char* kind : {"plain", "rubbed"}) {
    out << "set title 'bouncing on 5 N/mm, "
        << (kind == std::string("plain") ? "no friction" : "friction 0.1 N") << "'\nplot ";
    for (std::size_t i = 0; i < found.size(); ++i) {
      out << (i > 0 ? ", $" : "$") << kind << i << " with points pt 7 ps 1.8 lc " << i + 1
          << " title \"" << kIntegrators[i].name << '"';
      if (kIntegrators[i].step == nullptr)
        out << ", $" << kind << i << " with points pt 6 lw 2 ps 3.2 lc rgb 'black' notitle";
    }
    out << '\n';
  }
  gnuplot(to.options.out, "stability_integrators", out.str() + "unset multiplot\n");
}

}  // namespace

void stabilityIntegrators(const StabilityReport& to) {
  std::vector<Found> found;
  double truth_N_m = 0.0;
  std::vector<double> limits;
  for (const Integrator& integrator : kIntegrators) {
    const double soft = error_mm(integrator.step, 0.5, 0.0);
    const double stiff = error_mm(integrator.step, 5.0, 0.0);
    const double hard = error_mm(integrator.step, 20.0, 0.0);
    const double rubbed = error_mm(integrator.step, 5.0, 0.1);
    const double plain_ns = time_ns(integrator.step, 0.0);
    const double rubbed_ns = time_ns(integrator.step, 0.1);
    const double breaks = breakdown_N_m(integrator.step, 0.0);
    const double leads = breakdown_N_m(integrator.step, 1.2e-3);
    const bool is_default = integrator.step == nullptr;
    if (is_default) truth_N_m = breaks;
    limits.push_back(breaks);
    found.push_back({stiff, rubbed, plain_ns, rubbed_ns});
    to.report.add({"K 0.5", "integrator", integrator.name, soft, "mm", 0, is_default});
    to.report.add({"K 20", "integrator", integrator.name, hard, "mm", 0, is_default});
    to.report.add({"K 5", "integrator", integrator.name, stiff, "mm", plain_ns * 1e-3, is_default});
    to.report.add({"K 5 friction 0.1 N", "integrator", integrator.name, rubbed, "mm",
                   rubbed_ns * 1e-3, is_default});
    to.report.add(
        {"no damping", "integrator_breaks", integrator.name, breaks, "N/m", 0, is_default});
    to.report.add(
        {"lead 1.2 ms", "integrator_breaks", integrator.name, leads, "N/m", 0, is_default});
  }
  plot(to, found);
  to.report.require("exact one-tick integrator breaks where the truth does, 2b/T = 400 N/m", "2 %",
                    text("%.0f N/m", truth_N_m), std::abs(truth_N_m / 400.0 - 1.0) <= 0.02);
  to.report.require("semi-implicit Euler hides the instability", "shown",
                    text("stable to %.0f N/m where the truth is 400", limits[1]),
                    limits[1] > 4000.0);
}

}  // namespace hapticast::evaluate
