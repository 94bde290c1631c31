// SPDX-License-Identifier: MIT
// The parts of the topic network. Thread: each uses all cores.
#pragma once

#include <string>
#include <vector>

#include "tests/evaluate/network/network_viewer.hpp"
#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// A scene and the hand that touches it.
struct NetworkScene {
  std::string name;
  SentStream stream;
  Hand hand;
};

/// 20 ms each way and so much jitter.
testing::LinkProfile farLink(Duration jitter = {});

/// Bodies that move, turn, rise and change their shape.
std::vector<NetworkScene> networkScenes(double seconds);

/// Error of the force due to loss, jitter and delay.
void networkForce(const std::vector<NetworkScene>& scenes, double seconds, const Options& options,
                  Report& report);
/// The whole renderer through the same and worse: steps of the force, and what is left of it when
/// nothing comes any more.
void networkSafety(const std::vector<NetworkScene>& scenes, const Options& options, Report& report);
/// Error of the clock, playout delay, the first force of who joins.
void networkClocks(const NetworkScene& scene, double seconds, Report& report);

}  // namespace hapticast::evaluate
