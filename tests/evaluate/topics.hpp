// SPDX-License-Identifier: MIT
// The topics of hapticast-evaluate. Each measures, fills a Report and writes it.
#pragma once

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// The force against exact truth, against its run time: what is required, aimed at and got.
void evaluateAccuracy(const Options& options);
/// Slices of reliefs beside other codecs: bytes, time, error, and what they add to the force's.
void evaluateCodec(const Options& options);
/// The thesis's figures again.
void evaluateFigures(const Options& options);
void evaluateMotion(const Options& options);
/// The force through bad networks, by each transport; clocks and playout.
void evaluateNetwork(const Options& options);
/// Savings and costs of the plan against everything on; frames a second of the whole
/// server.
void evaluatePlan(const Options& options);
/// Stability of the 1 kHz loop: maps, the chain link by link, extreme cases.
void evaluateStability(const Options& options);
void evaluateVision(const Options& options);

}  // namespace hapticast::evaluate
