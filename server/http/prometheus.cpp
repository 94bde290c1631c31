// SPDX-License-Identifier: MIT
#include <fmt/core.h>

#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "common/text.hpp"
#include "server/http/metrics.hpp"

namespace hapticast::server {

namespace {

using Labels = std::vector<std::pair<std::string_view, std::string>>;

/// Returns `text` as a label's value: valid UTF-8, with the format's escapes.
std::string escapeLabel(std::string_view text) {
  std::string escaped;
  for (const char each : sanitizeUtf8(text)) {
    if (each == '\\' || each == '"') escaped += '\\';
    escaped += each;
  }
  return escaped;
}

/// Writes families of samples.
class PrometheusWriter {
 public:
  /// Begins the family hapticast_`name`.
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP hapticast_{0} {2}\n# TYPE hapticast_{0} {1}\n", name, type, help);
  }
  /// Adds a sample to the last family. `suffix`: of a summary's sum or count.
  template <class Number>
  void add(Number value, const Labels& labels = {}, std::string_view suffix = "") {
    text_ += fmt::format("hapticast_{}{}", name_, suffix);
    std::string_view before = "{";
    for (const auto& [label, content] : labels) {
      text_ += fmt::format("{}{}=\"{}\"", before, label, escapeLabel(content));
      before = ",";
    }
    text_ += fmt::format("{} {}\n", labels.empty() ? "" : "}", value);
  }
  /// Writes a family with a single sample.
  template <class Number>
  void write(std::string_view name, std::string_view type, std::string_view help, Number value) {
    begin(name, type, help);
    add(value);
  }
  [[nodiscard]] std::string take() && { return std::move(text_); }

 private:
  std::string text_;
  std::string_view name_;
};

constexpr std::string_view kGauge = "gauge";
constexpr std::string_view kCounter = "counter";

void writeServer(PrometheusWriter& out, const Metrics& metrics) {
  out.begin("build_info", kGauge, "1, with the version of the program.");
  out.add(1, {{"version", metrics.version}});
  out.begin("stream_info", kGauge, "1, with the name of the stream.");
  out.add(1, {{"stream", metrics.name}});
  out.write("healthy", kGauge, "1 while /health answers ok, otherwise 0.",
            findProblem(metrics) ? 0 : 1);
  out.write("uptime_seconds", kGauge, "Time since the start of the server.",
            toSeconds(metrics.uptime));
  out.write("source_frame_rate_hertz", kGauge, "Nominal frames a second of the source.",
            metrics.fps);
  out.write("clock_error_seconds", kGauge,
            "Largest error of the media clock against the clock that stamps the frames.",
            toSeconds(metrics.clock_error));
}

void writeViewers(PrometheusWriter& out, const StreamCounts& stream) {
  out.write("viewers", kGauge, "Viewers that are connected.", stream.clients);
  out.write("viewers_welcomed_total", kCounter, "Viewers that were welcomed.", stream.welcomed);
  out.write("viewers_refused_total", kCounter,
            "Connections that were closed: the server was full, or they broke the protocol.",
            stream.refused);
  out.write("viewers_timed_out_total", kCounter,
            "Connections that were closed because they sent or read nothing for too long.",
            stream.timed_out);
}

void writeFrames(PrometheusWriter& out, const Metrics& metrics) {
  const StreamCounts& stream = metrics.stream;
  out.write("frames_published_total", kCounter, "Frames that the server made for its viewers.",
            stream.frames);
  out.write("tcp_frames_sent_total", kCounter, "Frames sent by TCP, over all viewers.",
            stream.sent.frames_sent);
  out.write("pictures_sent_total", kCounter, "Pictures sent, over all viewers.",
            stream.sent.videos_sent);
  out.begin("tcp_frames_dropped_total", kCounter,
            "Frames that a slow viewer did not get by TCP, over all viewers.");
  out.add(stream.sent.frames_dropped_full, {{"cause", "queue_full"}});
  out.add(stream.sent.frames_dropped_old, {{"cause", "too_old"}});
  out.write("pictures_dropped_total", kCounter,
            "Pictures that a newer one replaced before they were sent, over all viewers.",
            stream.sent.videos_dropped);
  if (!stream.published_at) return;
  out.write("frame_delay_seconds", kGauge,
            "Delay of the newest frame from its capture to its publication.",
            toSeconds(stream.delay));
  out.write("frame_age_seconds", kGauge, "Time since the newest frame was published.",
            toSeconds(metrics.now - *stream.published_at));
}

void writeDelivery(PrometheusWriter& out, const Metrics& metrics) {
  out.begin("sent_bytes_total", kCounter,
            "Bytes sent to viewers, without the headers of TCP, UDP and IP.");
  out.add(metrics.stream.bytes, {{"transport", "tcp"}});
  if (!metrics.datagrams) return;
  const std::array<std::pair<const char*, const DatagramCounts*>, 2> transports{
      {{"udp", &metrics.datagrams->viewers}, {"multicast", &metrics.datagrams->group}}};
  for (const auto& [transport, counts] : transports)
    out.add(counts->bytes, {{"transport", transport}});
  out.begin("datagrams_sent_total", kCounter, "Datagrams with frames that were sent.");
  for (const auto& [transport, counts] : transports)
    out.add(counts->sent, {{"transport", transport}});
  out.begin("datagrams_unsent_total", kCounter,
            "Datagrams that were not sent: replaced by a newer frame, or rejected by the system.");
  for (const auto& [transport, counts] : transports) {
    out.add(counts->dropped, {{"transport", transport}, {"cause", "replaced"}});
    out.add(counts->failed, {{"transport", transport}, {"cause", "rejected"}});
  }
  out.write("unmatched_echoes_total", kCounter,
            "Datagrams to the server that did not match their viewer.",
            metrics.datagrams->rejectedEchoes());
}

void writePipeline(PrometheusWriter& out, const PipelineCounts& pipeline) {
  out.write("frames_skipped_total", kCounter,
            "Frames of the source that the server left out because it was late.", pipeline.skipped);
  out.begin("stage_duration_seconds", "summary",
            "Time of a stage: of vision for each object, the others for each frame or signature.");
  for (const auto& [name, time] : listStages(pipeline)) {
    const Labels labels{{"stage", std::string(name)}};
    out.add(toSeconds(time.sum), labels, "_sum");
    out.add(time.count, labels, "_count");
  }
  out.write("objects", kGauge, "Objects that the server tracks, at most 16.", pipeline.plan.size());
  if (pipeline.plan.empty()) return;
  out.begin("plan_stage_enabled", kGauge,
            "1 if the scene plan has the stage on; object: its place by id, from 0.");
  for (std::size_t object = 0; object < pipeline.plan.size(); ++object) {
    for (std::size_t stage = 0; stage < kStages; ++stage)
      out.add(pipeline.plan[object][stage] ? 1 : 0,
              {{"object", std::to_string(object)}, {"stage", std::string(kStageNames[stage])}});
  }
}

void writeRelay(PrometheusWriter& out, const RelayCounts& relay, LocalTime now) {
  const Labels role{{"role", relay.is_edge ? "edge" : "origin"}};
  out.begin("relay_connected", kGauge, "1 while the server is connected to NATS.");
  out.add(relay.connected ? 1 : 0, role);
  out.begin("relay_active", kGauge,
            "Origin: 1 while it is the active one. Edge: 1 while an origin sends.");
  out.add(relay.active ? 1 : 0, role);
  out.begin("relay_term", kGauge, "Term of the active origin; 0: none is known.");
  out.add(relay.term, role);
  if (!relay.heartbeat) return;
  out.begin("relay_heartbeat_age_seconds", kGauge,
            "Time since the last heartbeat of the active origin.");
  out.add(toSeconds(now - *relay.heartbeat), role);
}

}  // namespace

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

std::string writePrometheus(const Metrics& metrics) {
  PrometheusWriter out;
  writeServer(out, metrics);
  writeViewers(out, metrics.stream);
  writeFrames(out, metrics);
  writeDelivery(out, metrics);
  if (metrics.pipeline) writePipeline(out, *metrics.pipeline);
  if (metrics.relay) writeRelay(out, *metrics.relay, metrics.now);
  return std::move(out).take();
}

}  // namespace hapticast::server
