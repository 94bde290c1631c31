// SPDX-License-Identifier: MIT
// hapticast-evaluate TOPIC: error against run time.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <opencv2/core/utility.hpp>

#include "server/vision/segment/rules.hpp"
#include "tests/evaluate/recording_log.hpp"
#include "tests/evaluate/report_check.hpp"
#include "tests/evaluate/report_page.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {
namespace {

std::string listTopics() {
  std::string text = "Topics:\n";
  for (const auto& [name, topic] : topics()) text += "  " + name + ": " + topic.about + "\n";
  return text +
         "  all: these topics, one after the other\n  report: no measurement, only report.md "
         "from the CSV files in --out\n  log FILE.mcap: no measurement, only --out/log.png of a "
         "recording (--record of hapticast-client or hapticast-server)\n";
}

std::string listRules() {
  std::string text = "is none of";
  for (const char* name : server::kRuleNames) text += std::string("\n  ") + name;
  return text;
}

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--out", options.out,
                 "Folder for TOPIC.csv, TOPIC_NAME.csv, TOPIC.png and report.md")
      ->capture_default_str();
  app.add_option(
      "--only", options.only,
      "Of the scenes of motion or the parts of network (force, safety, clocks), vision "
      "(held, surface, deform, drawn, estimated, rules, or held/NAME for its scenes of this "
      "name) and "
      "stability (theory, maps, chain, silence, links, inertia, integrators, life, "
      "cases, false_streams, honest), only this one");
  app.add_option("--set", options.set,
                 "Which draw of the held scenes of vision: 1 is the one that methods are tuned on, "
                 "any other is drawn afresh")
      ->capture_default_str();
  const auto leaveOut = [](const std::string& name) {
    const auto* const found = std::find(server::kRuleNames.begin(), server::kRuleNames.end(), name);
    if (found == server::kRuleNames.end()) throw CLI::ValidationError("--without", listRules());
    server::rules_left_out.set(static_cast<std::size_t>(found - server::kRuleNames.begin()));
  };
  app.add_option_function<std::vector<std::string>>(
         "--without",
         [leaveOut](const std::vector<std::string>& names) {
           std::for_each(names.begin(), names.end(), leaveOut);
         },
         "A term or rule of the segmentation that vision leaves out; may be repeated")
      ->allow_extra_args(false);
  app.add_flag("--quick", options.quick, "Fewer scenes: about a minute a topic");
  app.add_flag(
      "--check", options.check,
      "Fail where a requirement is missed or a figure is 1.3 times worse than its baseline");
  app.add_option("--baseline", options.baseline,
                 "Folder of the baselines TOPIC.csv; without it tests/evaluate/report, with "
                 "--quick tests/evaluate/baseline");
}

// Returns whether all that was to be checked holds; a topic that fails does not end the others.
bool runTopics(const std::string& wanted, const Options& options) {
  bool good = true;
  for (const auto& [name, topic] : topics()) {
    if (wanted != "all" && wanted != name) continue;
    try {
      topic.evaluate(options);
    } catch (const CheckFailed& failed) {
      std::fprintf(stderr, "hapticast-evaluate: %s\n", failed.what());
      good = false;
    }
  }
  return good;
}

int run(int argc, char** argv) {
  CLI::App app("Measures hapticast against exact truth: error against run time, per topic.");
  app.footer(listTopics());
  std::string topic, recording;
  Options options;
  std::vector<std::string> names{"all", "report", "log"};
  for (const auto& [name, topic] : topics()) names.push_back(name);
  app.add_option("topic", topic, "What to measure")->required()->check(CLI::IsMember(names));
  app.add_option("recording", recording, "FILE.mcap of log");
  addOptions(app, options);
  try {
    app.parse(argc, argv);
    if ((topic == "log") == recording.empty())
      throw CLI::ValidationError("log", "draws one recording: hapticast-evaluate log FILE.mcap");
    if (options.check && options.set != 1)
      throw CLI::ValidationError("--check", "the baselines are of --set 1");
    if (options.check && server::rules_left_out.any())
      throw CLI::ValidationError("--check", "the baselines are without --without");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (topic == "log") {
    plotRecording(recording, options.out);
    return 0;
  }
  if (options.baseline.empty())
    options.baseline = options.quick ? "tests/evaluate/baseline" : "tests/evaluate/report";
  cv::setNumThreads(1);  // run times are of one thread
  const bool good = runTopics(topic, options);
  writeReport(options.out);
  return good ? 0 : 1;
}

}  // namespace
}  // namespace hapticast::evaluate

int main(int argc, char** argv) {
  try {
    return hapticast::evaluate::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapticast-evaluate: %s\n", error.what());
    return 1;
  }
}
