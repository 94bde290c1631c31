// SPDX-License-Identifier: MIT
// Servers that play the same frames, each to a crowd of its own, in turns so short that whatever
// else the machine does meets all of them alike. Thread: main.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/endpoint.hpp"
#include "tests/bench/viewers/cpu_time.hpp"
#include "tests/bench/viewers/crowd.hpp"
#include "tests/bench/viewers/servers.hpp"

namespace hapticast::testing {

enum class Contestant {
  kTcp,  ///< the server's broadcaster
  kUdp,
  kWebSocket,
  kBareTcp,
  kBareUdp,
  kMosquitto,
  kNats,
};

/// How the frames of a contestant come.
[[nodiscard]] Transport wayOf(Contestant who);

/// A server and its crowd.
class Contender {
 public:
  /// Starts the server.
  Contender(Contestant who, const Frames& frames);
  /// A server that runs already, and may be on this machine; it plays all the time.
  Contender(Transport way, const Endpoint& server, std::optional<pid_t> pid, const Frames& frames);

  void join();
  /// Plays and counts, while `all` receive.
  void play(Duration time, std::span<Crowd* const> all);
  [[nodiscard]] Crowd& crowd() { return *crowd_; }
  [[nodiscard]] const Crowd& crowd() const { return *crowd_; }
  /// Of a processor, for each frame that a viewer got; 0 where it is not known.
  [[nodiscard]] double network_us() const { return each_us(cpu_.network); }
  [[nodiscard]] double process_us() const { return each_us(cpu_.process); }
  [[nodiscard]] Duration played() const { return played_; }
  [[nodiscard]] std::optional<pid_t> pid() const { return pid_; }

 private:
  [[nodiscard]] double each_us(Duration cpu) const;

  Switch playing_;
  Frames frames_;
  bool runs_already_ = false;
  std::vector<std::unique_ptr<ServerProcess>> processes_;
  std::optional<pid_t> pid_;
  std::unique_ptr<Crowd> crowd_;
  CpuUsed cpu_;
  Duration played_{0};
};

}  // namespace hapticast::testing
