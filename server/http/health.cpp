// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <algorithm>

#include "server/http/metrics.hpp"

namespace hapticast::server {

namespace {

// Longest usual pause between frames; a source may have fewer frames a second than that.
constexpr Duration kLongestPause = std::chrono::seconds(2);
constexpr double kLongestPause_frames = 3.0;

std::optional<std::string> findRelayProblem(const RelayCounts& relay) {
  if (!relay.is_edge) return std::nullopt;  // an origin without NATS still has viewers of its own
  if (!relay.connected) return "this edge has no connection to NATS";
  if (!relay.active) return "this edge has no origin: none sends on its channel";
  return std::nullopt;
}

}  // namespace

std::optional<std::string> findProblem(const Metrics& metrics) {
  if (metrics.relay) {
    if (auto problem = findRelayProblem(*metrics.relay)) return problem;
  }
  if (metrics.pipeline && metrics.pipeline->phase != PipelinePhase::kStream) return std::nullopt;
  LocalTime since = metrics.pipeline ? metrics.pipeline->phase_since : metrics.now - metrics.uptime;
  if (metrics.stream.published_at) since = std::max(since, *metrics.stream.published_at);
  const Duration frames =
      metrics.fps > 0.0 ? fromSeconds(kLongestPause_frames / metrics.fps) : Duration::zero();
  const Duration silence = metrics.now - since;
  if (silence <= std::max(kLongestPause, frames)) return std::nullopt;
  return fmt::format("no frame for {:.1f} s", toSeconds(silence));
}

std::string describeActivity(const Metrics& metrics) {
  if (!metrics.pipeline) return "forwards the frames of its origin";
  switch (metrics.pipeline->phase) {
    case PipelinePhase::kScan:
      return "scans the clip";
    case PipelinePhase::kWaitForViewer:
      return "waits for the first viewer";
    case PipelinePhase::kStream:
      return "sends frames";
    case PipelinePhase::kPause:
      return "an operator has paused the stream";
    case PipelinePhase::kOnDemand:
      return "sends each viewer a recording on demand";
    case PipelinePhase::kSeek:
      return "an operator seeks";
  }
  return "";
}

}  // namespace hapticast::server
