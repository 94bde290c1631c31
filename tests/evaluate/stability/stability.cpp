// SPDX-License-Identifier: MIT
// Stability of the 1 kHz loop: maps against theory, the chain with and without each link, the
// inertia term, integrators, random life, extreme cases.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

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
  const StabilityReport to{report, options};
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
               {"discontinuities", stabilityDiscontinuities},
               {"false_streams", stabilityFalseStreams},
               {"honest", stabilityHonest}};
  for (const auto& [name, run] : parts) {
    if (!options.only.empty() && options.only != name) continue;
    const auto begin = std::chrono::steady_clock::now();
    run(to);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::fprintf(stderr, "-- %s: %.1f s\n", name, took.count());
  }
  report.write();
}

const RegisteredTopic kStabilityTopic(
    "stability",
    {.about = "the 1 kHz loop with device, hand and safety chain",
     .method =
         "The real chain, motion filters and virtual device under a virtual clock. Every run "
         "begins with an impact. The truth is the theory of sampled walls, and limits on the "
         "force and the energy that a hand may get. Units: N/mm, N·s/m, delays d in ticks "
         "beyond the millisecond of hold; a count is 0.055 mm, unless a row states another size.",
     .evaluate = evaluateStability,
     .pictures = {
         {"stability.png", "what is left of an impact over stiffness, damping, delay and hand"},
         {"stability_counts.png", "the same without a hand for three counts"},
         {"stability_energy.png", "the same: work into the hand"},
         {"stability_integrators.png", "integrators: error against run time"},
         {"stability_cases.png", "six extreme cases: naive loop and chain"}}});

}  // namespace hapticast::evaluate
