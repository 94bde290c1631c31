// SPDX-License-Identifier: MIT
// The force against exact truth: displacement x stiffness of the surface model, before damping and
// chain, along scripted paths (client/haptics/README.md).
#include <algorithm>
#include <mutex>
#include <optional>

#include "tests/evaluate/accuracy/accuracy_parts.hpp"
#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/topics.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kThesisLong_s = 8.0;  // its server takes its time, and it needs no more to be off

// All cores; what they find is reported in the cases' order, as soon as it can be.
class Work {
 public:
  Work(const std::vector<Case>& cases, Report& report)
      : cases_(cases), report_(report), outcomes_(cases.size()) {}

  void run() {
    onAllCores(cases_.size(), [this](std::size_t i) { reportOutcome(i, cases_[i]()); });
  }

 private:
  void reportOutcome(std::size_t i, Outcome outcome) {
    const std::lock_guard lock(mutex_);
    outcomes_[i] = std::move(outcome);
    for (; logged_ < cases_.size() && outcomes_[logged_]; ++logged_) {
      for (const Row& row : outcomes_[logged_]->rows) report_.add(row);
      for (const Goal& goal : outcomes_[logged_]->goals) report_.add(goal);
    }
  }

  const std::vector<Case>& cases_;
  Report& report_;
  std::mutex mutex_;  // guards what follows
  std::vector<std::optional<Outcome>> outcomes_;
  std::size_t logged_ = 0;
};

}  // namespace

Streams makeStreams(const TouchScene& scene, StreamKind kind) {
  Streams out;
  kind.method = Method::kHapticast;
  out.ours = makeStream(scene, kind);
  kind.method = Method::kThesis;
  kind.longest_s = std::min(kind.longest_s, kThesisLong_s);
  out.theirs = makeStream(scene, kind);
  return out;
}

std::vector<ForceTrace> renderTraces(const Streams& streams, const std::vector<Variant>& variants,
                                     const Hand& hand, const PlayTimes& times) {
  const auto of = [&](Method method) -> const Stream& { return streams.of(method); };
  return renderTraces(of, variants, hand, times);
}

Row rowOf(const std::string& scene, const std::string& stage, const Variant& variant, double error,
          const std::string& unit, double tick_us) {
  return {scene, stage, variant.name, error, unit, tick_us, variant.is_default, variant.is_thesis};
}

static void evaluateAccuracy(const Options& options) {
  Report report("accuracy", options);
  report.timesAreOfTicks();
  std::vector<Case> cases;
  for (const auto& part :
       {smoothCases(options.quick), wallCases(options.quick), motionCases(options.quick),
        frictionCases(options.quick), loopCases(options.quick), dynamicCases(options.quick)})
    cases.insert(cases.end(), part.begin(), part.end());
  Work(cases, report).run();
  report.write();
}

const RegisteredTopic kAccuracyTopic(
    "accuracy",
    {.about = "the force, through vision and wire; about 3 minutes on two cores",
     .method = "The force of every surface model, sampler and interpolation in time, of side "
               "walls, rims, held contacts, friction, inertia and impacts. The truth is the exact "
               "displacement along scripted paths of a hand. The error is the rms of the "
               "difference over the rms of the truth, over the ticks in which the truth is in "
               "contact. Depth has 8 bits (255 levels over 30 mm) at 25 frames/s and goes through "
               "server and wire, with the source's exact mask.",
     .evaluate = evaluateAccuracy});

}  // namespace hapticast::evaluate
