// SPDX-License-Identifier: MIT
// The figures for operators: their text for Prometheus is read back by a strict reader of the
// format (0.0.4), and /health knows each state.
#include "server/http/metrics.hpp"

#include <gtest/gtest.h>

#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "server/pipeline/pipeline_counter.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Samples by name with labels, as in the text.
using Samples = std::map<std::string, double>;

/// Removes and returns one label, `name="value"`, with the escapes of the value undone.
std::pair<std::string, std::string> takeLabel(std::string_view& text) {
  static const std::regex kName("[a-zA-Z_][a-zA-Z0-9_]*");
  const std::size_t equals = text.find("=\"");
  std::pair<std::string, std::string> label{text.substr(0, equals), ""};
  EXPECT_TRUE(std::regex_match(label.first, kName)) << text;
  if (equals == std::string_view::npos) throw std::runtime_error("no label");
  text.remove_prefix(equals + 2);
  while (!text.empty() && text.front() != '"') {
    if (text.front() == '\\') {
      text.remove_prefix(1);
      EXPECT_TRUE(text.front() == '\\' || text.front() == '"' || text.front() == 'n') << text;
    }
    label.second += text.front();
    text.remove_prefix(1);
  }
  if (text.empty()) throw std::runtime_error("no end of a label");
  text.remove_prefix(1);
  return label;
}

/// Reads the labels of a sample, `{a="b",...}`, up to its value.
std::string readLabels(std::string_view& text) {
  if (text.front() != '{') return "";
  std::string labels;
  std::set<std::string> names;
  do {
    text.remove_prefix(1);
    const auto [name, value] = takeLabel(text);
    EXPECT_TRUE(names.insert(name).second) << "twice: " << name;
    labels += (labels.empty() ? "" : ",") + name + "=" + value;
  } while (text.starts_with(','));
  EXPECT_TRUE(text.starts_with('}')) << text;
  text.remove_prefix(1);
  return "{" + labels + "}";
}

double readValue(std::string_view text) {
  double value = 0.0;
  EXPECT_TRUE(text.starts_with(' ')) << text;
  const auto parsed = std::from_chars(text.data() + 1, text.data() + text.size(), value);
  EXPECT_TRUE(parsed.ec == std::errc() && parsed.ptr == text.data() + text.size()) << text;
  return value;
}

/// One family of the text: HELP, TYPE, then its samples only.
struct Family {
  std::string name;
  std::string type;

  void add(const std::string& line, Samples& samples) const {
    std::string_view text = line;
    ASSERT_TRUE(text.starts_with(name)) << line;
    text.remove_prefix(name.size());
    std::string suffix;
    for (const char* each : {"_sum", "_count"}) {
      if (type == "summary" && text.starts_with(each)) suffix = each;
    }
    EXPECT_EQ(type == "summary", !suffix.empty()) << line;
    text.remove_prefix(suffix.size());
    const std::string labels = readLabels(text);
    const double value = readValue(text);
    EXPECT_TRUE(samples.emplace(name.substr(10) + suffix + labels, value).second)
        << "twice: " << line;
    EXPECT_TRUE(type != "counter" || (value >= 0.0 && name.ends_with("_total"))) << line;
    EXPECT_TRUE(type == "counter" || !name.ends_with("_total")) << line;
  }
};

/// Reads the whole text, without "hapticast_" in the names.
Samples read(const std::string& text) {
  static const std::regex kHelp("# HELP (hapticast_[a-z0-9_]+) ([^\\\\]+\\.)");
  static const std::regex kType("# TYPE (hapticast_[a-z0-9_]+) (gauge|counter|summary)");
  EXPECT_TRUE(text.ends_with('\n'));
  Samples samples;
  std::set<std::string> names;
  Family family;
  std::string helped;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, match, kHelp)) {
      helped = match[1];
      EXPECT_TRUE(names.insert(helped).second) << "twice: " << helped;
    } else if (std::regex_match(line, match, kType)) {
      EXPECT_EQ(match[1], helped);
      family = {match[1], match[2]};
    } else {
      family.add(line, samples);
    }
  }
  return samples;
}

/// A server with everything, one second after its start.
Metrics everything() {
  Metrics all;
  all.version = "1.2.3";
  all.name = "ball";
  all.fps = 25.0;
  all.now = localTime(11.0);
  all.uptime = seconds(1);
  all.stream.clients = 3;
  all.stream.websockets = 2;
  all.stream.frames = 24;
  all.stream.bytes = 5000;
  all.stream.sent.frames_dropped_full = 7;
  all.stream.delay = milliseconds(125);
  all.stream.published_at = localTime(10.75);
  all.datagrams.emplace();
  all.datagrams->viewers = {11, 12, 13, 14};
  all.datagrams->group.sent = 15;
  all.pipeline.emplace();
  all.pipeline->phase = PipelinePhase::kStream;
  all.pipeline->phase_since = localTime(10.0);
  all.pipeline->stages[0] = {milliseconds(1500), 30};
  all.pipeline->plan.resize(2);
  all.pipeline->plan[1][1] = true;
  all.relay = RelayCounts{false, true, true, 42, localTime(10.5)};
  return all;
}

TEST(Prometheus, ShowsEveryFigureOnce) {
  const Samples samples = read(writePrometheus(everything()));
  EXPECT_EQ(samples.at("build_info{version=1.2.3}"), 1.0);
  EXPECT_EQ(samples.at("viewers"), 3.0);
  EXPECT_EQ(samples.at("viewers_by_way{way=tcp}"), 1.0);
  EXPECT_EQ(samples.at("viewers_by_way{way=websocket}"), 2.0);
  EXPECT_EQ(samples.at("frames_published_total"), 24.0);
  EXPECT_EQ(samples.at("sent_bytes_total{transport=tcp}"), 5000.0);
  EXPECT_EQ(samples.at("sent_bytes_total{transport=udp}"), 14.0);
  EXPECT_EQ(samples.at("datagrams_sent_total{transport=multicast}"), 15.0);
  EXPECT_EQ(samples.at("datagrams_unsent_total{transport=udp,cause=replaced}"), 12.0);
  EXPECT_EQ(samples.at("datagrams_unsent_total{transport=udp,cause=rejected}"), 13.0);
  EXPECT_EQ(samples.at("tcp_frames_dropped_total{cause=queue_full}"), 7.0);
  EXPECT_EQ(samples.at("frame_delay_seconds"), 0.125);
  EXPECT_EQ(samples.at("frame_age_seconds"), 0.25);
  EXPECT_EQ(samples.at("stage_duration_seconds_sum{stage=segment}"), 1.5);
  EXPECT_EQ(samples.at("stage_duration_seconds_count{stage=segment}"), 30.0);
  EXPECT_EQ(samples.at("plan_stage_enabled{object=1,stage=clean}"), 1.0);
  EXPECT_EQ(samples.at("plan_stage_enabled{object=0,stage=clean}"), 0.0);
  EXPECT_EQ(samples.at("relay_term{role=origin}"), 42.0);
  EXPECT_EQ(samples.at("relay_heartbeat_age_seconds{role=origin}"), 0.5);
  EXPECT_EQ(samples.at("healthy"), 1.0);
}

TEST(Prometheus, LeavesOutFiguresThatAServerDoesNotHave) {
  const Samples samples = read(writePrometheus(Metrics{}));
  for (const auto& [name, value] : samples) {
    for (const char* part : {"relay", "stage", "udp", "frame_age", "objects"})
      EXPECT_EQ(name.find(part), std::string::npos) << name;
  }
  EXPECT_EQ(samples.at("viewers"), 0.0);
}

TEST(Prometheus, EscapesTheNameOfTheStream) {
  Metrics metrics;
  metrics.name = "a \"b\" \\ c\nd} 1\xFF";
  const Samples samples = read(writePrometheus(metrics));
  EXPECT_EQ(samples.count("stream_info{stream=a \"b\" \\ c?d} 1?}"), 1U);
  EXPECT_EQ(nlohmann::json::parse(writeStatus(metrics)).at("stream"), "a \"b\" \\ c?d} 1?");
}

TEST(Status, HasTheSameFiguresAsJson) {
  const auto status = nlohmann::json::parse(writeStatus(everything()));
  EXPECT_EQ(status.at("health"), "ok");
  EXPECT_EQ(status.at("stream"), "ball");
  EXPECT_EQ(status.at("uptime_s"), 1.0);
  EXPECT_EQ(status.at("viewers").at("present"), 3);
  EXPECT_EQ(status.at("viewers").at("websocket"), 2);
  EXPECT_EQ(status.at("frames").at("delay_s"), 0.125);
  EXPECT_EQ(status.at("udp").at("bytes"), 14);
  EXPECT_EQ(status.at("pipeline").at("stages").at("segment").at("sum_s"), 1.5);
  EXPECT_EQ(status.at("pipeline").at("plan").at(1).at("clean"), true);
  EXPECT_EQ(status.at("relay").at("term"), 42);
  EXPECT_FALSE(nlohmann::json::parse(writeStatus(Metrics{})).contains("relay"));
}

TEST(Health, OfAServerWithItsOwnSource) {
  Metrics metrics = everything();
  EXPECT_EQ(findProblem(metrics), std::nullopt);
  metrics.now = localTime(12.75);
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "two seconds are allowed";
  metrics.now = localTime(14.0);
  EXPECT_EQ(findProblem(metrics), "no frame for 3.2 s");
  metrics.pipeline->phase = PipelinePhase::kWaitForViewer;
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "it waits as it should";
  metrics.pipeline->phase = PipelinePhase::kScan;
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "it scans the clip";
  metrics.pipeline->phase = PipelinePhase::kStream;
  metrics.pipeline->phase_since = localTime(13.0);
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "it has just begun to stream";
  metrics.stream.published_at.reset();
  metrics.now = localTime(15.5);
  EXPECT_EQ(findProblem(metrics), "no frame for 2.5 s");
  metrics.fps = 0.5;
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "frames of this source are two seconds apart";
}

TEST(Health, OfAnEdge) {
  Metrics metrics;
  metrics.now = localTime(100.0);
  metrics.uptime = seconds(1);
  metrics.relay = RelayCounts{true, false, false, 0, std::nullopt};
  EXPECT_EQ(findProblem(metrics), "this edge has no connection to NATS");
  metrics.relay->connected = true;
  EXPECT_EQ(findProblem(metrics), "this edge has no origin: none sends on its channel");
  metrics.relay->active = true;
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "the first frame may take two seconds";
  metrics.uptime = seconds(9);
  EXPECT_EQ(findProblem(metrics), "no frame for 9.0 s");
  metrics.stream.published_at = localTime(99.0);
  EXPECT_EQ(findProblem(metrics), std::nullopt);
  metrics.relay = RelayCounts{false, false, false, 0, std::nullopt};
  EXPECT_EQ(findProblem(metrics), std::nullopt) << "a standby origin has viewers of its own";
}

TEST(Health, DescribesTheActivity) {
  Metrics metrics;
  EXPECT_EQ(describeActivity(metrics), "forwards the frames of its origin");
  metrics.pipeline.emplace();
  const std::vector<std::pair<PipelinePhase, std::string>> phases{
      {PipelinePhase::kScan, "scans the clip"},
      {PipelinePhase::kWaitForViewer, "waits for the first viewer"},
      {PipelinePhase::kStream, "sends frames"},
      {PipelinePhase::kPause, "an operator has paused the stream"},
      {PipelinePhase::kSeek, "an operator seeks"}};
  for (const auto& [phase, text] : phases) {
    metrics.pipeline->phase = phase;
    EXPECT_EQ(describeActivity(metrics), text);
  }
}

TEST(PipelineCounter, AddsUpStagesThatAreOn) {
  ManualClock clock;
  PipelineCounter counter(clock);
  EXPECT_EQ(counter.counts().phase, PipelinePhase::kScan);
  counter.enter(PipelinePhase::kStream);
  const PlanLine on{Stage::kClean, true, "", 2.0, 0.0};
  const PlanLine off{Stage::kSmooth, false, "", 3.0, 0.0};
  counter.addFrame(milliseconds(5), {{70, {on, off}}, {71, {on}}});
  counter.addFrame(milliseconds(6), {{71, {on}}});
  counter.set(4, {{milliseconds(7), 2}, {}}, {milliseconds(8), 3});
  const PipelineCounts counts = counter.counts();
  EXPECT_EQ(counts.phase, PipelinePhase::kStream);
  EXPECT_EQ(counts.vision.sum, milliseconds(11));
  EXPECT_EQ(counts.vision.count, 2U);
  EXPECT_EQ(counts.stages[static_cast<std::size_t>(Stage::kClean)].sum, milliseconds(6));
  EXPECT_EQ(counts.stages[static_cast<std::size_t>(Stage::kClean)].count, 3U);
  EXPECT_EQ(counts.stages[static_cast<std::size_t>(Stage::kSmooth)].count, 0U);
  EXPECT_EQ(counts.plan.size(), 1U) << "the objects of the newest frame";
  std::map<std::uint32_t, std::vector<PlanLine>> many;
  for (std::uint32_t id = 0; id < 100; ++id) many[id] = {on};
  counter.addFrame(milliseconds(6), many);
  EXPECT_EQ(counter.counts().plan.size(), kMaxObjects) << "the series stay few";
  EXPECT_EQ(counts.skipped, 4U);
  EXPECT_EQ(counts.encoder.encode.count, 2U);
  EXPECT_EQ(counts.sign.sum, milliseconds(8));
}

}  // namespace
}  // namespace hapticast::server
