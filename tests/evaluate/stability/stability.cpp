// SPDX-License-Identifier: MIT
// Stability of the 1 kHz loop: maps against theory, the chain with and without each link, the
// inertia term, integrators, random life, extreme cases.
#include <chrono>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

void Claims::add(const std::string& claim, const std::string& required, const std::string& got,
                 bool held) {
  claims_.push_back({claim, required, got, held});
  std::fprintf(stderr, "%s: required %s, got %s%s\n", claim.c_str(), required.c_str(), got.c_str(),
               held ? "" : "  <-- MISSED");
}

std::string Claims::table() const {
  std::vector<std::vector<std::string>> lines{{"claim", "required", "got", "held"}};
  for (const Claim& c : claims_) {
    lines.push_back({c.claim, c.required, c.got, c.held ? "yes" : "**no**"});
  }
  return markdown(lines);
}

void Claims::requireIn(Report& report) const {
  for (const Claim& c : claims_) report.require(c.claim, c.held);
}

Law bareLaw(double damping_Ns_m, double peak_N) {
  return [=](const client::SafetyInput& in) {
    client::SafetyOutput out;
    out.contact = in.contact;
    if (!in.contact) return out;
    out.penetration_mm = in.displacement_mm.norm();
    const double u_mm_s = (in.surface_velocity_mm_s - in.velocity_mm_s).dot(in.normal);
    const double force_N =
        in.stiffness_N_mm * in.displacement_mm.dot(in.normal) + damping_Ns_m * 1e-3 * u_mm_s;
    const Vec3 sum_N = std::max(0.0, force_N) * in.normal + in.dynamic_N;
    const double size_N = sum_N.norm();
    if (!std::isfinite(force_N) || !(size_N > 0.0)) return out;
    out.force_N = sum_N * (std::min(size_N, peak_N) / size_N);
    return out;
  };
}

static void evaluateStability(const Options& options) {
  Report report("stability", options);
  Claims claims;
  const StabilityReport to{report, claims, options};
  const struct {
    const char* name;
    void (*run)(const StabilityReport&);
  } parts[] = {{"theory", stabilityTheory},
               {"maps", stabilityMaps},
               {"chain", stabilityChain},
               {"silence", stabilitySilence},
               {"links", stabilityLinks},
               {"inertia", stabilityInertia},
               {"integrators", stabilityIntegrators},
               {"life", stabilityLife},
               {"cases", stabilityCases},
               {"lies", stabilityFalseStreams},
               {"honest", stabilityHonest}};
  for (const auto& [name, run] : parts) {
    if (!options.only.empty() && options.only != name) continue;
    const auto begin = std::chrono::steady_clock::now();
    run(to);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::fprintf(stderr, "-- %s: %.1f s\n", name, took.count());
  }
  claims.requireIn(report);
  report.sayFirst(
      "The real chain, motion filters and virtual device under a virtual clock; every run begins "
      "with an impact. Units: N/mm, N·s/m, delays in ticks beyond the millisecond of hold, a count "
      "is 0.055 mm where nothing else is said.\n\n" +
      claims.table());
  report.write();
}

const RegisteredTopic kStabilityTopic("stability",
                                      "the 1 kHz loop with device, hand and safety chain",
                                      evaluateStability);

}  // namespace hapticast::evaluate
