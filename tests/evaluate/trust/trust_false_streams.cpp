// SPDX-License-Identifier: MIT
// False streams at a hand: each one goes through the wire to the client's parts. Work and steps are
// computed from the sent forces and the true motion.
#include <algorithm>
#include <set>

#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/scenes/false_streams/run_false_stream.hpp"

namespace hapticast::evaluate {

namespace {

using testing::Verdict;

struct NamedRun {
  const testing::FalseStream* false_stream;
  client::FalseStreamRun got;
};

// The surface rests and nothing else pushes: what the hand gets comes through the relative port.
const std::set<std::string> kRelative = {"stiff_pump_7hz",
                                         "stiff_square_10hz",
                                         "stiffness_flip",
                                         "stiff_pump_in_step_0",
                                         "stiff_pump_in_step_90",
                                         "stiff_pump_in_step_180",
                                         "stiff_pump_in_step_270",
                                         "stiff_pump_bounded_7hz",
                                         "friction_1_5_stroke",
                                         "friction_pump",
                                         "stiff_noise"};

constexpr double kTouched_s = 2.0;  // the hand has come by then

/// States that the user cannot miss.
bool isStated(const client::FalseStreamRun& run) {
  using client::SafetyState;
  return (run.last.safety_states & (bit(SafetyState::kMovesHand) | bit(SafetyState::kTrustLost))) !=
         0;
}

/// Energy of streams that no value of the product was chosen with, and the state that the user
/// sees.
void drawnFalseStreams(const StabilityReport& to, double seconds) {
  const auto streams = testing::drawFalseStreams(20261128, to.options.quick ? 25 : 75);
  std::vector<client::FalseStreamRun> runs(streams.size());
  onAllCores(runs.size(),
             [&](std::size_t i) { runs[i] = client::runFalseStream(streams[i], seconds); });
  double most_mJ = 0.0;
  std::string most_of = "-";
  int silent = 0;
  bool finite = true;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double work_mJ = runs[i].trace.mostWork_mJ(10.0);
    if (work_mJ > most_mJ) most_of = streams[i].name;
    most_mJ = std::max(most_mJ, work_mJ);
    silent += work_mJ > client::SafetyStates::kMovesHand_mJ && !isStated(runs[i]) ? 1 : 0;
    finite = finite && runs[i].trace.finite && runs[i].trace.max_force_N <= 3.3 + 1e-9;
    to.report.add({streams[i].name, "drawn_false_stream_work", "client", work_mJ, "mJ", 0.0, true});
  }
  to.report.require(
      text("drawn false streams (%zu): net work on the user's port, largest over any 10 s",
           runs.size()),
      "<= 300 mJ (aim 150); finite, <= 3.3 N", text("%.0f mJ (%s)", most_mJ, most_of.c_str()),
      finite && most_mJ <= 300.0);
  to.report.require("drawn false streams: above 100 mJ without a state in the window", "none",
                    text("%d", silent), silent == 0);
}

}  // namespace

void stabilityFalseStreams(const StabilityReport& to) {
  const double seconds = to.options.quick ? 8.0 : 21.0;
  const double net_s = to.options.quick ? 3.0 : 10.0;
  std::vector<NamedRun> runs;
  for (const testing::FalseStream& false_stream : testing::falseStreams())
    runs.push_back({&false_stream, {}});
  onAllCores(runs.size(), [&](std::size_t i) {
    runs[i].got = client::runFalseStream(*runs[i].false_stream, seconds);
  });
  Table lines{{"false stream", "verdict", "force N", "mJ in 10 s", "step N up", "down",
               "step not the tip's N"}};
  double most_mJ = 0.0;
  double relative_mJ = -1e9;
  double meter_mJ = 0.0;
  std::string meter_of = "none";
  int misread = 0;
  int in_the_end = 0;  // only limited in a shorter run
  std::vector<std::string> differing;
  differing.reserve(runs.size());
  double most_N = 0.0;
  bool finite = true;
  int silent = 0;
  for (const NamedRun& run : runs) {
    const client::ForceTrace& trace = run.got.trace;
    const Verdict verdict = run.got.verdict();
    if (run.false_stream->verdict == Verdict::kLimited && verdict == Verdict::kTrustLost)
      ++in_the_end;
    else if (!run.got.is(run.false_stream->verdict))
      differing.push_back(run.false_stream->name);
    const double work_mJ = trace.mostWork_mJ(10.0);
    most_mJ = std::max(most_mJ, work_mJ);
    silent += work_mJ > client::SafetyStates::kMovesHand_mJ && !isStated(run.got) ? 1 : 0;
    if (kRelative.contains(run.false_stream->name))
      relative_mJ = std::max(relative_mJ, trace.netWork_mJ(kTouched_s, net_s));
    const double sum_mJ = trace.work_mJ.back();
    const double off_mJ = std::abs(trace.metered_mJ - sum_mJ);
    if (off_mJ > std::max(2.0, 0.05 * std::abs(sum_mJ))) {
      ++misread;
      if (off_mJ > meter_mJ)
        meter_of = text("%s, of %.0f mJ", run.false_stream->name.c_str(), sum_mJ);
      meter_mJ = std::max(meter_mJ, off_mJ);
    }
    most_N = std::max(most_N, trace.max_force_N);
    finite = finite && trace.finite;
    to.report.add({run.false_stream->name, "false_stream_work", testing::verdictName(verdict),
                   work_mJ, "mJ", 0.0, true});
    lines.push_back({run.false_stream->name, testing::verdictName(verdict),
                     text("%.2f", trace.max_force_N), text("%.0f", work_mJ),
                     text("%.2f", trace.max_rise_N), text("%.2f", trace.max_fall_N),
                     text("%.2f", trace.max_unexplained_N)});
  }
  to.report.require(
      text("false streams (%zu, %.0f s each): all forces finite, largest", runs.size(), seconds),
      "<= 3.3 N", text("%.2f N", most_N), finite && most_N <= 3.3 + 1e-9);
  to.report.require("false streams that meet another verdict than theirs", "none",
                    text("%zu (%s); %d limited ones lost trust in the end", differing.size(),
                         differing.empty() ? "-" : differing.front().c_str(), in_the_end),
                    differing.empty());
  to.report.require("false streams: net work on the user's port, largest over any 10 s",
                    "<= 300 mJ (aim 150)", text("%.0f mJ", most_mJ), most_mJ <= 300.0);
  to.report.require("false streams: above 100 mJ without a state in the window", "none",
                    text("%d", silent), silent == 0);
  to.report.require(
      text("false streams: relative port under pumped stiffness and friction, net of %.0f s",
           net_s),
      "<= 3 mJ (aim 1)", text("%.1f mJ", relative_mJ), relative_mJ <= 3.0);
  to.report.require(
      "false streams: the client's meters against the energy summed from forces and true ways",
      "all within 5 % or 2 mJ",
      text("%d of %zu are not, off by %.1f mJ at most (%s)", misread, runs.size(), meter_mJ,
           meter_of.c_str()),
      misread == 0);
  to.report.addTable("false_streams", lines);
  drawnFalseStreams(to, seconds);
}

}  // namespace hapticast::evaluate
