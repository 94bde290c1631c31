// SPDX-License-Identifier: MIT
// Vision measured on scenes as people record them: masks from one click, from clicks anywhere,
// after corrections; relief, velocity, run time. Thread: it uses all cores.
#pragma once

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Adds rows, tables, required figures and contact sheets. `--only held` leaves out the rest of the
/// topic, `--only held/NAME` takes the scenes whose name begins so.
void measureHeld(const Options& options, Report& report);

/// Results of surface, range, layers and hold for the same scenes where the source gives the true
/// masks: relief used, rest, layers that change their names. `--only surface[/NAME]`.
void measureHeldSurfaces(const Options& options, Report& report);

/// The grid of things that squeeze and bend, the grid of rigid ones (it should be empty), and
/// the velocity of both, with the true masks. `--only deform[/NAME]`.
void measureDeforming(const Options& options, Report& report);

/// What each term and rule of the segmentation is worth on the held scenes: the IoU without it.
/// `--only rules`, `--only rules/PART_OF_A_NAME`.
void measureRules(const Options& options, Report& report);

}  // namespace hapticast::evaluate
