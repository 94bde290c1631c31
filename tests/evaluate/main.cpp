// SPDX-License-Identifier: MIT
// hapticast-evaluate TOPIC: error against run time.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <opencv2/core/utility.hpp>

#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {
namespace {

int run(int argc, char** argv) {
  const std::map<std::string, void (*)(const Options&)> topics{
      {"accuracy", evaluateAccuracy},   {"codec", evaluateCodec},     {"figures", evaluateFigures},
      {"motion", evaluateMotion},       {"network", evaluateNetwork}, {"plan", evaluatePlan},
      {"stability", evaluateStability}, {"vision", evaluateVision}};
  CLI::App app("Measures hapticast against exact truth: error against run time, per topic.");
  app.footer(
      "Topics:\n"
      "  accuracy  the force (surface models, samplers, interpolation in time, friction, inertia, "
      "impacts)\n            against the exact one, through vision and wire; about 3 minutes on "
      "two "
      "cores\n"
      "  codec     heights on the wire: bytes, time and error beside other codecs\n"
      "  motion    velocity, acceleration and impacts of every estimator\n"
      "  network   the force through loss, jitter and cuts, by each transport; clocks; about ten "
      "minutes\n"
      "  plan      what the plan saves and costs; frames a second of the whole server\n"
      "  vision    masks and reliefs");
  std::string topic;
  Options options;
  std::vector<std::string> names{"all"};
  for (const auto& [name, run] : topics) names.push_back(name);
  app.add_option("topic", topic, "What to measure")->required()->check(CLI::IsMember(names));
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
  app.add_flag("--check", options.check,
               "Fail where a required figure is missed (accuracy, codec, network)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  cv::setNumThreads(1);  // run times are of one thread
  for (const auto& [name, evaluate] : topics) {
    if (topic == "all" || topic == name) evaluate(options);
  }
  writeReport(options.out, names);
  return 0;
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
