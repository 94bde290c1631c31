// SPDX-License-Identifier: MIT
// Figures of one server for operators, and their text for Prometheus. Thread: any.
#pragma once

#include <optional>
#include <string>

#include "server/pipeline/pipeline_counts.hpp"
#include "server/relay/relay_counts.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

/// All figures at one time.
struct Metrics {
  std::string version;      ///< of the program
  std::string name;         ///< of the stream; from an author or an origin, so any bytes
  double fps = 0.0;         ///< frames/s of the source; 0: not known yet
  LocalTime now{};          ///< time of this snapshot
  Duration uptime{0};       ///< since the server's start
  Duration clock_error{0};  ///< largest error of the media clock; 0 without a relay
  StreamCounts stream;
  std::optional<DatagramSenderCounts> datagrams;  ///< nullopt: --transport tcp
  std::optional<PipelineCounts> pipeline;         ///< nullopt: an edge
  std::optional<RelayCounts> relay;               ///< nullopt: neither an origin nor an edge
};

/// Health check: returns nullopt if the server publishes frames, or is in a phase in which it needs
/// not publish (scan, wait for a viewer, pause, seek). Otherwise returns the problem in one line.
[[nodiscard]] std::optional<std::string> findProblem(const Metrics& metrics);
/// Returns what the server does at present, in some words, for example "sends frames".
[[nodiscard]] std::string describeActivity(const Metrics& metrics);
/// Returns the figures in the text format 0.0.4 of Prometheus.
[[nodiscard]] std::string writePrometheus(const Metrics& metrics);
/// Returns the figures as a JSON object.
[[nodiscard]] std::string writeStatus(const Metrics& metrics);

}  // namespace hapticast::server
