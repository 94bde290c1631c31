// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "tests/evaluate/network/network_parts.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kSettled_s = 6.0;  // the estimator's window has gone by

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct ClockCase {
  std::string name;
  Network network;
  double required_ms, aim_ms;
};

void clockErrors(const NetworkScene& scene, double seconds, Report& report) {
  testing::LinkProfile loopback;
  loopback.delay = std::chrono::microseconds(50);
  loopback.jitter = std::chrono::microseconds(100);
  testing::LinkProfile uneven = farLink(std::chrono::milliseconds(20));
  uneven.delay = std::chrono::milliseconds(10);  // 20 +- 10 ms
  const std::vector<ClockCase> cases{
      {"clock error on the loopback", {true, 0, loopback}, 0.2, 0.05},
      {"clock error through 20 +- 10 ms", {true, 0, uneven}, 2.0, 1.0},
      {"clock error under a drift of 200 ms/h, 20 +- 10 ms",
       {true, 0, uneven, 0.2 / 3600.0},
       2.0,
       0.5}};
  for (const ClockCase& each : cases) {
    double first_ms = 0.0, worst_ms = 0.0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      Network network = each.network;
      network.link.seed = seed;
      for (const NetworkTick& tick :
           renderThroughNetwork(scene.stream, network, scene.hand, seconds).ticks) {
        if (!tick.clock_offset) continue;
        double& worst = tick.time_s < kSettled_s ? first_ms : worst_ms;
        worst = std::max(worst, std::abs(tick.clock_error_ms));
      }
    }
    report.add({each.name, "clock, first seconds", "pings", first_ms, "ms", 0.0, true, false});
    report.add({each.name, "clock", "pings", worst_ms, "ms", 0.0, true, false});
    report.add(Goal{each.name + text(", after %g s, worst of 8 seeds", kSettled_s), "ms",
                    each.required_ms, each.aim_ms, worst_ms});
  }
}

// Wait of play time beyond the need of 95 of 100 frames and of the interpolation.
void playoutDelay(const NetworkScene& scene, double seconds, Report& report) {
  const double interval_ms = 1e3 / scene.stream.description.fps;
  double worst_ms = -1e9;
  for (const testing::Jitter kind :
       {testing::Jitter::kUniform, testing::Jitter::kNormal, testing::Jitter::kExponential}) {
    for (const int jitter_ms : {5, 10, 20}) {
      Network network{true, 1, farLink(std::chrono::milliseconds(jitter_ms))};
      network.link.distribution = kind;
      const NetworkTrace trace = renderThroughNetwork(scene.stream, network, scene.hand, seconds);
      const double needed_ms = quantile(trace.conversation.waited_ms, 0.95) + interval_ms;
      double over_ms = 0.0;
      int ticks = 0;
      for (const NetworkTick& tick : trace.ticks) {
        if (tick.time_s < kSettled_s) continue;
        // A clock that is off shifts both alike.
        over_ms += tick.delay_ms - tick.clock_error_ms - needed_ms;
        ++ticks;
      }
      over_ms /= ticks;
      const char* const names[] = {"uniform", "normal", "exponential"};
      report.add({text("%d ms, %s", jitter_ms, names[static_cast<int>(kind)]), "playout_delay",
                  "over the 0.95 quantile and the interpolation's need", over_ms, "ms", 0.0, true,
                  false});
      worst_ms = std::max(worst_ms, over_ms);
    }
  }
  report.add(
      Goal{"playout delay over the 0.95 quantile + interpolation need, steady jitter, "
           "worst of 9",
           "frames", 1.0, 0.5, worst_ms / interval_ms});
}

}  // namespace

void networkClocks(const NetworkScene& scene, double seconds, Report& report) {
  clockErrors(scene, seconds, report);
  playoutDelay(scene, seconds, report);
}

}  // namespace hapticast::evaluate
