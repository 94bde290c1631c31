// SPDX-License-Identifier: MIT
// The force against exact truth: displacement x stiffness of the surface model, before damping and
// chain, along scripted paths (DESIGN section 4, proxy notes section 5).
#include <atomic>
#include <exception>
#include <thread>

#include "tests/evaluate/accuracy_parts.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

namespace {

// Both cores; the outcomes stay in the cases' order.
std::vector<Outcome> runAll(const std::vector<Case>& cases) {
  constexpr std::size_t kThreads = 2;
  std::vector<Outcome> outcomes(cases.size());
  std::vector<std::exception_ptr> errors(kThreads);
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      try {
        for (std::size_t i = next++; i < cases.size(); i = next++) outcomes[i] = cases[i]();
      } catch (...) {
        errors[t] = std::current_exception();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  return outcomes;
}

}  // namespace

Streams makeStreams(const TouchScene& scene, StreamKind kind) {
  Streams out;
  kind.method = Method::kHapticast;
  out.ours = makeStream(scene, kind);
  kind.method = Method::kThesis;
  out.theirs = makeStream(scene, kind);
  return out;
}

std::vector<Felt> feelAll(const Streams& streams, const std::vector<Variant>& variants,
                          const Hand& hand, const PlayTimes& times) {
  const auto of = [&](Method method) -> const Stream& { return streams.of(method); };
  return feelAll(of, variants, hand, times);
}

Row rowOf(const std::string& scene, const std::string& stage, const Variant& variant, double error,
          const std::string& unit, double tick_us) {
  return {scene, stage, variant.name, error, unit, tick_us, variant.is_default, variant.is_thesis};
}

void evaluateAccuracy(const Options& options) {
  Report report("accuracy", options);
  report.timesAreOfTicks();
  report.say(
      "Displacement of the surface model (x stiffness: the force) along scripted paths, against "
      "the "
      "exact one: relative RMS over the ticks in which the truth is in contact. 8-bit depth (255 "
      "levels over 30 mm), 25 fps, through the server's enhancement and motion and through the "
      "wire, with the source's exact mask; `own mask`: segmented by the server, its error beside "
      "it. Times: look-up and surface of a tick. Where a force stands, it is at 0.5 N/mm.");
  std::vector<Case> cases;
  for (const auto& part :
       {smoothCases(options.quick), wallCases(options.quick), motionCases(options.quick),
        frictionCases(options.quick), dynamicCases(options.quick)})
    cases.insert(cases.end(), part.begin(), part.end());
  for (const Outcome& outcome : runAll(cases)) {
    for (const Row& row : outcome.rows) report.add(row);
    for (const Goal& goal : outcome.goals) report.add(goal);
  }
  report.write();
}

}  // namespace hapticast::evaluate
