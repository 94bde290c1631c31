// SPDX-License-Identifier: MIT
// The parts of the stability topic, and what they share: laws other than the chain's.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/gnuplot.hpp"
#include "tests/evaluate/report.hpp"
#include "tests/support/plant_sweep.hpp"

namespace hapticast::evaluate {

struct StabilityReport {
  Report& report;
  const Options& options;
};

/// Of the Phantom Omni at its tip, as its data sheet has it.
inline constexpr double kOmniMass_kg = 0.045;

/// Force on the tip from what is touched, instead of the chain.
using Law = std::function<client::SafetyOutput(const client::SafetyInput&)>;
/// F = max(0, K d + B u), clamped to `peak_N`: no limits, no fades.
Law bareLaw(double damping_Ns_m, double peak_N);

void stabilityMaps(const StabilityReport& to);
void stabilityTheory(const StabilityReport& to);
void stabilityChain(const StabilityReport& to);
void stabilitySilence(const StabilityReport& to);
/// The rows of `silence` in which the hand moves.
void stabilityMoving(const StabilityReport& to);
void stabilityLinks(const StabilityReport& to);
void stabilityInertia(const StabilityReport& to);
void stabilityIntegrators(const StabilityReport& to);
void stabilityLife(const StabilityReport& to);
void stabilityCases(const StabilityReport& to);
void stabilityHonest(const StabilityReport& to);
/// Energy of discontinuities at a still plate, and of late ticks.
void stabilityDiscontinuities(const StabilityReport& to);
void stabilityFalseStreams(const StabilityReport& to);

}  // namespace hapticast::evaluate
