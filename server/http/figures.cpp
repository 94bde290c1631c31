// SPDX-License-Identifier: MIT
#include "server/http/figures.hpp"

#include <fmt/core.h>

#include <array>
#include <string>
#include <utility>

namespace hapticast::server {

namespace {

/// Collects figures by family.
class FigureList {
 public:
  /// Begins the family hapticast_`name`.
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    next_.name = name;
    next_.type = type;
    next_.help = help;
  }
  /// Adds a figure to the last family. `suffix`: of a summary's sum or count.
  void add(FigureValue value, std::string json_pointer, FigureLabels labels = {},
           std::string_view suffix = "") {
    next_.value = value;
    next_.json_pointer = std::move(json_pointer);
    next_.labels = std::move(labels);
    next_.suffix = suffix;
    figures.push_back(next_);
  }
  /// Adds a family of one figure.
  void add(std::string_view name, std::string_view type, std::string_view help, FigureValue value,
           std::string json_pointer) {
    begin(name, type, help);
    add(value, std::move(json_pointer));
  }

  std::vector<Figure> figures;

 private:
  Figure next_;
};

constexpr std::string_view kGauge = "gauge";
constexpr std::string_view kCounter = "counter";

void addServer(FigureList& out, const Metrics& metrics) {
  out.begin("build_info", kGauge, "1, with the version of the program.");
  out.add(true, "", {{"version", metrics.version}});
  out.begin("stream_info", kGauge, "1, with the name of the stream.");
  out.add(true, "", {{"stream", metrics.name}});
  out.add("healthy", kGauge, "1 while /health answers ok, otherwise 0.", !findProblem(metrics), "");
  out.add("uptime_seconds", kGauge, "Time since the start of the server.",
          toSeconds(metrics.uptime), "/uptime_s");
  out.add("source_frame_rate_hertz", kGauge, "Nominal frames a second of the source.", metrics.fps,
          "/source_fps");
  out.add("clock_error_seconds", kGauge,
          "Largest error of the media clock against the clock that stamps the frames.",
          toSeconds(metrics.clock_error), "/clock_error_s");
}

void addViewers(FigureList& out, const StreamCounts& stream) {
  out.add("viewers", kGauge, "Viewers that are connected.", stream.clients, "/viewers/present");
  out.begin("viewers_by_way", kGauge, "Viewers that are connected, by the way of their bytes.");
  out.add(stream.clients - stream.websockets, "/viewers/tcp", {{"way", "tcp"}});
  out.add(stream.websockets, "/viewers/websocket", {{"way", "websocket"}});
  out.add("viewers_welcomed_total", kCounter, "Viewers that were welcomed.", stream.welcomed,
          "/viewers/welcomed");
  out.add("viewers_refused_total", kCounter,
          "Connections that were closed: the server was full, or they broke the protocol.",
          stream.refused, "/viewers/refused");
  out.add("viewers_timed_out_total", kCounter,
          "Connections that were closed because they sent or read nothing for too long.",
          stream.timed_out, "/viewers/timed_out");
}

void addFrames(FigureList& out, const Metrics& metrics) {
  const StreamCounts& stream = metrics.stream;
  out.add("frames_published_total", kCounter, "Frames that the server made for its viewers.",
          stream.frames, "/frames/published");
  out.add("frames_stale_total", kCounter,
          "Frames that were left out because they were too old when they were ready.",
          stream.frames_stale, "/frames/stale");
  out.add("tcp_frames_sent_total", kCounter, "Frames sent by TCP, over all viewers.",
          stream.sent.frames_sent, "/tcp/frames_sent");
  out.add("pictures_sent_total", kCounter, "Pictures sent, over all viewers.",
          stream.sent.videos_sent, "/tcp/pictures_sent");
  out.begin("tcp_frames_dropped_total", kCounter,
            "Frames that a slow viewer did not get by TCP, over all viewers.");
  out.add(stream.sent.frames_dropped_full, "/tcp/frames_dropped_full", {{"cause", "queue_full"}});
  out.add(stream.sent.frames_dropped_old, "/tcp/frames_dropped_old", {{"cause", "too_old"}});
  out.add("pictures_dropped_total", kCounter,
          "Pictures that a newer one replaced before they were sent, over all viewers.",
          stream.sent.videos_dropped, "/tcp/pictures_dropped");
  if (!stream.published_at) return;
  out.add("frame_delay_seconds", kGauge,
          "Delay of the newest frame from its capture to its publication.", toSeconds(stream.delay),
          "/frames/delay_s");
  out.add("frame_age_seconds", kGauge, "Time since the newest frame was published.",
          toSeconds(metrics.now - *stream.published_at), "/frames/age_s");
}

void addDelivery(FigureList& out, const Metrics& metrics) {
  out.begin("sent_bytes_total", kCounter,
            "Bytes sent to viewers, without the headers of TCP, UDP and IP.");
  out.add(metrics.stream.bytes, "/tcp/bytes", {{"transport", "tcp"}});
  if (!metrics.datagrams) return;
  const std::array<std::pair<std::string, const DatagramCounts*>, 2> transports{
      {{"udp", &metrics.datagrams->viewers}, {"multicast", &metrics.datagrams->group}}};
  for (const auto& [transport, counts] : transports)
    out.add(counts->bytes, "/" + transport + "/bytes", {{"transport", transport}});
  out.begin("datagrams_sent_total", kCounter, "Datagrams with frames that were sent.");
  for (const auto& [transport, counts] : transports)
    out.add(counts->sent, "/" + transport + "/sent", {{"transport", transport}});
  out.begin("datagrams_unsent_total", kCounter,
            "Datagrams that were not sent: replaced by a newer frame, or rejected by the system.");
  for (const auto& [transport, counts] : transports) {
    out.add(counts->dropped, "/" + transport + "/replaced",
            {{"transport", transport}, {"cause", "replaced"}});
    out.add(counts->failed, "/" + transport + "/rejected",
            {{"transport", transport}, {"cause", "rejected"}});
  }
  out.add("unmatched_echoes_total", kCounter,
          "Datagrams to the server that did not match their viewer.",
          metrics.datagrams->rejectedEchoes(), "/unmatched_echoes");
}

/// Time of one stage, by its name.
struct NamedStage {
  std::string_view name;
  StageTime time;
};

/// Returns the stages of vision, then vision as a whole, the encoder and the signer.
std::vector<NamedStage> listStages(const PipelineCounts& pipeline) {
  std::vector<NamedStage> stages;
  for (std::size_t i = 0; i < kStages; ++i) {
    // The plan switches the stage `heights` by what is sent; nothing runs in it.
    if (static_cast<Stage>(i) != Stage::kHeights)
      stages.push_back({kStageNames[i], pipeline.stages[i]});
  }
  stages.push_back({"vision", pipeline.vision});
  stages.push_back({"encode", pipeline.encoder.encode});
  stages.push_back({"picture", pipeline.encoder.picture});
  stages.push_back({"sign", pipeline.sign});
  return stages;
}

void addPipeline(FigureList& out, const PipelineCounts& pipeline) {
  out.add("frames_skipped_total", kCounter,
          "Frames of the source that the server left out because it was late.", pipeline.skipped,
          "/pipeline/frames_skipped");
  out.begin("stage_duration_seconds", "summary",
            "Time of a stage: of vision for each object, the others for each frame or signature.");
  for (const auto& [name, time] : listStages(pipeline)) {
    const std::string stage(name);
    const std::string json_pointer = "/pipeline/stages/" + stage;
    out.add(toSeconds(time.sum), json_pointer + "/sum_s", {{"stage", stage}}, "_sum");
    out.add(time.count, json_pointer + "/count", {{"stage", stage}}, "_count");
  }
  out.add("objects", kGauge, "Objects that the server tracks, at most 16.", pipeline.plan.size(),
          "");
  if (pipeline.plan.empty()) return;
  out.begin("plan_stage_enabled", kGauge,
            "1 if the scene plan has the stage on; object: its place by id, from 0.");
  for (std::size_t object = 0; object < pipeline.plan.size(); ++object) {
    for (std::size_t i = 0; i < kStages; ++i) {
      const std::string place = std::to_string(object);
      const std::string stage(kStageNames[i]);
      out.add(bool{pipeline.plan[object][i]}, fmt::format("/pipeline/plan/{}/{}", place, stage),
              {{"object", place}, {"stage", stage}});
    }
  }
}

void addRelay(FigureList& out, const RelayCounts& relay, LocalTime now) {
  const FigureLabels role{{"role", relay.is_edge ? "edge" : "origin"}};
  out.begin("relay_connected", kGauge, "1 while the server is connected to NATS.");
  out.add(relay.connected, "/relay/connected", role);
  out.begin("relay_active", kGauge,
            "Origin: 1 while it is the active one. Edge: 1 while an origin sends.");
  out.add(relay.active, "/relay/active", role);
  out.begin("relay_term", kGauge, "Term of the active origin; 0: none is known.");
  out.add(relay.term, "/relay/term", role);
  if (!relay.heartbeat) return;
  out.begin("relay_heartbeat_age_seconds", kGauge,
            "Time since the last heartbeat of the active origin.");
  out.add(toSeconds(now - *relay.heartbeat), "/relay/heartbeat_age_s", role);
}

}  // namespace

std::vector<Figure> listFigures(const Metrics& metrics) {
  FigureList out;
  addServer(out, metrics);
  addViewers(out, metrics.stream);
  addFrames(out, metrics);
  addDelivery(out, metrics);
  if (metrics.pipeline) addPipeline(out, *metrics.pipeline);
  if (metrics.relay) addRelay(out, *metrics.relay, metrics.now);
  return std::move(out.figures);
}

}  // namespace hapticast::server
