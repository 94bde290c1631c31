// SPDX-License-Identifier: MIT
// An extreme case: what came of it with the chain and with the naive loop K d and clamp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hapticast::evaluate {

struct CaseOutcome {
  double peak_N = 0.0;
  double step_N = 0.0;      ///< largest change of the force in a tick
  double excess_N = 0.0;    ///< of it, beyond what the hand explains and S more (chain)
  double speed_mm_s = 0.0;  ///< of the tip away from the surface (up)
  double energy_mJ = 0.0;   ///< most that went into the hand since the event
  double end_N = 0.0;       ///< force at the end
  bool finite = true;
  std::uint32_t safety_actions = 0;
  std::vector<double> trace_N, trace_mm_s;  ///< force and the tip's speed up, tick by tick
};

struct ExtremeCase {
  std::string name;
  double allowed_N = 0.0;  ///< the device's peak
  CaseOutcome naive, chain;
};

/// A wall, a virtual device, a light hand: what happens to the wall, the tip, the clock.
std::vector<ExtremeCase> planeCases();
/// Those plane cases whose force at walls of 0.5, 1 and 5 N/mm is not as it has to be: not finite,
/// above the peak, a step beyond what the hand explains, or outside the case's own limits.
std::vector<std::string> findUnexpectedForces();
/// Cases of a stream, through the whole renderer: frames in and force out.
std::vector<ExtremeCase> rendererCases();

}  // namespace hapticast::evaluate
