// SPDX-License-Identifier: MIT
#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "common/text.hpp"
#include "server/http/metrics.hpp"

namespace hapticast::server {

namespace {

using Json = nlohmann::ordered_json;

constexpr int kIndent = 2;

Json toJson(const DatagramCounts& counts) {
  return {{"sent", counts.sent},
          {"bytes", counts.bytes},
          {"replaced", counts.dropped},
          {"rejected", counts.failed}};
}

Json frames(const Metrics& metrics) {
  const StreamCounts& stream = metrics.stream;
  Json frames{{"published", stream.frames}};
  if (stream.published_at) {
    frames["delay_s"] = toSeconds(stream.delay);
    frames["age_s"] = toSeconds(metrics.now - *stream.published_at);
  }
  return frames;
}

Json toJson(const PipelineCounts& pipeline) {
  constexpr std::array kPhases{"scan", "wait_for_viewer", "stream", "pause"};
  Json stages = Json::object();
  for (const auto& [name, time] : listStages(pipeline))
    stages[std::string(name)] = {{"sum_s", toSeconds(time.sum)}, {"count", time.count}};
  Json plan = Json::array();
  for (const auto& object : pipeline.plan) {
    Json& on = plan.emplace_back(Json::object());
    for (std::size_t i = 0; i < kStages; ++i) on[std::string(kStageNames[i])] = object[i];
  }
  return {{"phase", kPhases[static_cast<std::size_t>(pipeline.phase)]},
          {"frames_skipped", pipeline.skipped},
          {"stages", stages},
          {"plan", plan}};
}

Json toJson(const RelayCounts& relay, LocalTime now) {
  Json json{{"role", relay.is_edge ? "edge" : "origin"},
            {"connected", relay.connected},
            {"active", relay.active},
            {"term", relay.term}};
  if (relay.heartbeat) json["heartbeat_age_s"] = toSeconds(now - *relay.heartbeat);
  return json;
}

}  // namespace

std::string writeStatus(const Metrics& metrics) {
  const StreamCounts& stream = metrics.stream;
  const auto problem = findProblem(metrics);
  Json json{{"version", metrics.version},
            {"stream", sanitizeUtf8(metrics.name)},
            {"health", problem.value_or("ok")},
            {"uptime_s", toSeconds(metrics.uptime)},
            {"source_fps", metrics.fps},
            {"clock_error_s", toSeconds(metrics.clock_error)},
            {"viewers",
             {{"present", stream.clients},
              {"welcomed", stream.welcomed},
              {"refused", stream.refused},
              {"timed_out", stream.timed_out}}},
            {"frames", frames(metrics)},
            {"tcp",
             {{"bytes", stream.bytes},
              {"frames_sent", stream.sent.frames_sent},
              {"frames_dropped_full", stream.sent.frames_dropped_full},
              {"frames_dropped_old", stream.sent.frames_dropped_old},
              {"pictures_sent", stream.sent.videos_sent},
              {"pictures_dropped", stream.sent.videos_dropped}}}};
  if (metrics.datagrams) {
    json["udp"] = toJson(metrics.datagrams->viewers);
    json["multicast"] = toJson(metrics.datagrams->group);
    json["unmatched_echoes"] = metrics.datagrams->rejectedEchoes();
  }
  if (metrics.pipeline) json["pipeline"] = toJson(*metrics.pipeline);
  if (metrics.relay) json["relay"] = toJson(*metrics.relay, metrics.now);
  return json.dump(kIndent) + "\n";
}

}  // namespace hapticast::server
