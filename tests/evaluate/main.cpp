// SPDX-License-Identifier: MIT
// hapticast-evaluate TOPIC: error against run time.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <opencv2/core/utility.hpp>

#include "tests/evaluate/report_check.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {
namespace {

using Topics = std::map<std::string, void (*)(const Options&)>;

constexpr const char* kFooter =
    "Topics:\n"
    "  accuracy   the force (surface models, samplers, interpolation in time, friction, inertia, "
    "impacts)\n             against the exact one, through vision and wire; about 3 minutes on two "
    "cores\n"
    "  codec      heights on the wire: bytes, time and error beside other codecs\n"
    "  figures    figures of the thesis again, by its method and by ours\n"
    "  motion     velocity, acceleration and impacts of every estimator\n"
    "  network    the force through loss, jitter and cuts, by each transport; clocks; about ten "
    "minutes\n"
    "  plan       what the plan saves and costs; frames a second of the whole server\n"
    "  stability  the 1 kHz loop with device, hand and safety chain\n"
    "  vision     masks and reliefs";

void addOptions(CLI::App& app, Options& options) {
  app.add_option("--out", options.out, "Folder for TOPIC.csv, TOPIC.png and TOPIC.md")
      ->capture_default_str();
  app.add_option("--only", options.only,
                 "Of the scenes of motion or the parts of network (force, safety, clocks), vision "
                 "(held, surface, deform, or held/NAME for its scenes of this name) and "
                 "stability (theory, maps, chain, silence, links, inertia, integrators, life, "
                 "cases, lies, honest), only this one");
  app.add_option("--set", options.set,
                 "Which draw of the held scenes of vision: 1 is the one that methods are tuned on, "
                 "any other is drawn afresh")
      ->capture_default_str();
  app.add_flag("--quick", options.quick, "Fewer scenes: about a minute a topic");
  app.add_flag(
      "--check", options.check,
      "Fail where a requirement is missed or a figure is 1.3 times worse than its baseline");
  app.add_option("--baseline", options.baseline,
                 "Folder of the baselines TOPIC.csv; without it tests/evaluate/report, with "
                 "--quick tests/evaluate/baseline");
}

// Returns whether all that was to be checked holds; a topic that fails does not end the others.
bool runTopics(const Topics& topics, const std::string& wanted, const Options& options) {
  bool good = true;
  for (const auto& [name, evaluate] : topics) {
    if (wanted != "all" && wanted != name) continue;
    try {
      evaluate(options);
    } catch (const CheckFailed& failed) {
      std::fprintf(stderr, "hapticast-evaluate: %s\n", failed.what());
      good = false;
    }
  }
  return good;
}

int run(int argc, char** argv) {
  const Topics topics{{"accuracy", evaluateAccuracy},   {"codec", evaluateCodec},
                      {"figures", evaluateFigures},     {"motion", evaluateMotion},
                      {"network", evaluateNetwork},     {"plan", evaluatePlan},
                      {"stability", evaluateStability}, {"vision", evaluateVision}};
  CLI::App app("Measures hapticast against exact truth: error against run time, per topic.");
  app.footer(kFooter);
  std::string topic;
  Options options;
  std::vector<std::string> names{"all"};
  for (const auto& [name, evaluate] : topics) names.push_back(name);
  app.add_option("topic", topic, "What to measure")->required()->check(CLI::IsMember(names));
  addOptions(app, options);
  try {
    app.parse(argc, argv);
    if (options.check && options.set != 1)
      throw CLI::ValidationError("--check", "the baselines are of --set 1");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.baseline.empty())
    options.baseline = options.quick ? "tests/evaluate/baseline" : "tests/evaluate/report";
  cv::setNumThreads(1);  // run times are of one thread
  const bool good = runTopics(topics, topic, options);
  writeReport(options.out, names);
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
