// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/curves.hpp"
#include "tests/evaluate/network/network_parts.hpp"

namespace hapticast::evaluate {

namespace {

// The viewer has come, the hand touches: from here on everything counts, also how it learns what
// the network is like.
constexpr double kFrom_s = 1.0;

struct Condition {
  std::string name;     // of the network
  std::string variant;  // transport and copies
  Network network;
  double required = 0.0;  // %, added; 0: nothing is
  double aim = 0.0;
};

struct Run {
  const Condition* condition;
  const NetworkScene* scene;
  std::uint64_t seed;
  double error = 0.0;
  double added = 0.0;
  double delay_ms = 0.0;
  double copies = 0.0;
};

std::vector<Condition> conditions(bool quick) {
  std::vector<Condition> out;
  const auto each = [&](const std::string& name, const testing::LinkProfile& link, double required,
                        double aim) {
    out.push_back({name, "UDP", {true, 0, link}, required, aim});
    for (const std::uint32_t copies : {1U, 2U, 3U}) {
      if (!quick) out.push_back({name, text("UDP, %u copies", copies), {true, copies, link}});
    }
    out.push_back({name, "TCP", {false, 1, link}});
  };
  each("no loss", farLink(), 0.0, 0.0);
  const Duration jitter = std::chrono::milliseconds(10);
  each("jitter 10 ms", farLink(jitter), 1.0, 0.5);
  struct Lossy {
    double loss, required, aim;
  };
  for (const Lossy& lossy : {Lossy{0.01, 1.0, 0.5}, Lossy{0.05, 3.0, 1.0}, Lossy{0.1, 6.0, 3.0},
                             Lossy{0.2, 12.0, 6.0}}) {
    for (const double burst : {1.0, 5.0}) {
      testing::LinkProfile link = farLink(jitter);
      link.loss = lossy.loss;
      link.burst = burst;
      const char* const how =
          burst > 1.0 ? "%g %% lost in bursts of 5, jitter 10 ms" : "%g %% lost, jitter 10 ms";
      each(text(how, 100.0 * lossy.loss), link, lossy.required, lossy.aim);
    }
  }
  testing::LinkProfile far = farLink(std::chrono::milliseconds(30));
  far.delay = std::chrono::milliseconds(150);
  far.distribution = testing::Jitter::kExponential;
  far.loss = 0.02;
  far.reorder = 0.05;
  far.duplicate = 0.02;
  each("another continent: 150 + 30 ms exponential, 2 % lost, 5 % overtaken", far, 0.0, 0.0);
  return out;
}

// The displacement of a run as a function of play time, which rises by about a millisecond a tick.
class ByPlayTime {
 public:
  explicit ByPlayTime(const std::vector<NetworkTick>& ticks) : ticks_(ticks) {}
  // Times have to rise from call to call.
  Vec3 at(double time_s) {
    while (next_ + 1 < ticks_.size() && ticks_[next_].time_s < time_s) ++next_;
    if (next_ == 0) return ticks_[0].displacement_mm;
    const NetworkTick &a = ticks_[next_ - 1], &b = ticks_[next_];
    const double span_s = b.time_s - a.time_s;
    const double share = span_s > 0.0 ? std::clamp((time_s - a.time_s) / span_s, 0.0, 1.0) : 1.0;
    return a.displacement_mm + share * (b.displacement_mm - a.displacement_mm);
  }

 private:
  const std::vector<NetworkTick>& ticks_;
  std::size_t next_ = 0;
};

void measure(Run& run, const std::vector<NetworkTick>& ticks,
             const std::vector<NetworkTick>& lossless) {
  ByPlayTime undisturbed(lossless);
  double error = 0.0, added = 0.0, truth = 0.0;
  for (const NetworkTick& tick : ticks) {
    run.delay_ms += tick.delay_ms / double(ticks.size());
    if (tick.truth_mm == Vec3::Zero() || tick.time_s < kFrom_s) continue;
    error += (tick.displacement_mm - tick.truth_mm).squaredNorm();
    added += (tick.displacement_mm - undisturbed.at(tick.time_s)).squaredNorm();
    truth += tick.truth_mm.squaredNorm();
  }
  run.error = 100.0 * std::sqrt(error / truth);
  run.added = 100.0 * std::sqrt(added / truth);
}

// Of all runs of a condition with a scene.
struct Sum {
  double error = 0.0, added = 0.0, most_added = 0.0, delay_ms = 0.0, copies = 0.0;
  int count = 0;

  void add(const Run& run) {
    error += run.error * run.error;
    added += run.added * run.added;
    most_added = std::max(most_added, run.added);
    delay_ms += run.delay_ms;
    copies += run.copies;
    ++count;
  }
  [[nodiscard]] double meanError() const { return std::sqrt(error / count); }
  [[nodiscard]] double meanAdded() const { return std::sqrt(added / count); }
};

// A curve for each variant over the share that is lost; `bursts`: in bursts, else one by one.
CurvePanel panel(const std::string& title, const std::string& label,
                 const std::vector<Condition>& conditions, const std::vector<Sum>& sums,
                 bool bursts, const std::function<double(const Sum&)>& value) {
  const std::vector<std::string> colors{"#d62728", "#9ecae1", "#4292c6", "#08519c", "#909090"};
  CurvePanel out{title, "lost, %", label, {}};
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    const testing::LinkProfile& link = conditions[i].network.link;
    // Every curve begins with jitter alone.
    const bool wanted = link.loss > 0.0 ? (link.burst > 1.0) == bursts : link.jitter > Duration{0};
    if (!wanted || link.reorder > 0.0) continue;
    const auto same = [&](const Curve& curve) { return curve.name == conditions[i].variant; };
    auto curve = std::find_if(out.curves.begin(), out.curves.end(), same);
    if (curve == out.curves.end()) {
      const std::string& color = colors[out.curves.size() % colors.size()];
      curve = out.curves.insert(curve, Curve{conditions[i].variant, color, {}, 2.0});
    }
    curve->points.push_back({100.0 * link.loss, value(sums[i])});
  }
  return out;
}

void draw(const std::vector<Condition>& conditions, const std::vector<Sum>& sums,
          const Options& options) {
  const auto added = [](const Sum& sum) { return sum.meanAdded(); };
  const auto delay_ms = [](const Sum& sum) { return sum.delay_ms / sum.count; };
  std::vector<CurvePanel> errors{
      panel("lost one by one", "added force error, %", conditions, sums, false, added),
      panel("lost in bursts of 5", "added force error, %", conditions, sums, true, added)};
  std::vector<CurvePanel> delays{
      panel("lost one by one", "playout delay, ms", conditions, sums, false, delay_ms),
      panel("lost in bursts of 5", "playout delay, ms", conditions, sums, true, delay_ms)};
  shareScale(errors);
  shareScale(delays);
  errors.insert(errors.end(), delays.begin(), delays.end());
  plotCurves(options.out / "network.png", errors, 2);
}

void reportRuns(const std::vector<Condition>& conditions, const std::vector<Run>& runs,
                const Options& options, Report& report) {
  std::vector<Sum> sums;
  sums.reserve(conditions.size());
  Table lines{
      {"network", "transport", "error, %", "added, %", "worst run, %", "delay, ms", "copies"}};
  for (const Condition& condition : conditions) {
    std::map<std::string, Sum> scenes;
    Sum all;
    for (const Run& run : runs) {
      if (run.condition != &condition) continue;
      scenes[run.scene->name].add(run);
      all.add(run);
    }
    sums.push_back(all);
    for (const auto& [name, sum] : scenes) {
      const bool is_default = condition.variant == "UDP";
      const std::string scene = name + ", " + condition.name;
      report.add({scene, "force", condition.variant, sum.meanError(), "%", 0.0, is_default, false});
      report.add(
          {scene, "added_force", condition.variant, sum.meanAdded(), "%", 0.0, is_default, false});
    }
    lines.push_back({condition.name, condition.variant, text("%.2f", all.meanError()),
                     text("%.2f", all.meanAdded()), text("%.2f", all.most_added),
                     text("%.0f", all.delay_ms / all.count), text("%.2f", all.copies / all.count)});
    if (condition.required > 0.0 && condition.variant == "UDP")
      report.add(Goal{"force error added, UDP, " + condition.name, "%", condition.required,
                      condition.aim, all.meanAdded()});
  }
  draw(conditions, sums, options);
  report.addTable("force", lines);
}

}  // namespace

void networkForce(const std::vector<NetworkScene>& scenes, double seconds, const Options& options,
                  Report& report) {
  const std::vector<Condition> all = conditions(options.quick);
  std::vector<Run> runs;
  for (const Condition& condition : all) {
    for (const NetworkScene& scene : scenes) {
      for (std::uint64_t seed = 1; seed <= (options.quick ? 1U : 4U); ++seed)
        runs.push_back({&condition, &scene, seed});
    }
  }
  std::vector<NetworkTrace> lossless(scenes.size());
  onAllCores(scenes.size(), [&](std::size_t i) {
    lossless[i] =
        renderThroughNetwork(scenes[i].stream, {true, 1, farLink()}, scenes[i].hand, seconds);
  });
  onAllCores(runs.size(), [&](std::size_t i) {
    Run& run = runs[i];
    Network network = run.condition->network;
    network.link.seed = run.seed;
    const NetworkTrace trace =
        renderThroughNetwork(run.scene->stream, network, run.scene->hand, seconds);
    const auto scene = static_cast<std::size_t>(run.scene - scenes.data());
    measure(run, trace.ticks, lossless[scene].ticks);
    run.copies = trace.conversation.mean_copies;
  });
  reportRuns(all, runs, options, report);
}

}  // namespace hapticast::evaluate
