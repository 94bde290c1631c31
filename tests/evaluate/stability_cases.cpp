// SPDX-License-Identifier: MIT
// The table of extreme cases.
#include "tests/evaluate/stability_cases.hpp"

#include <algorithm>

#include "tests/evaluate/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

std::string namesOf(std::uint32_t interferences) {
  std::string all;
  for (std::size_t i = 0; i < client::kInterferenceNames.size(); ++i) {
    if (((interferences >> i) & 1U) == 0) continue;
    all += (all.empty() ? "" : " ") + std::string(client::kInterferenceNames[i]);
  }
  return all.empty() ? "nothing had to be done" : all;
}

std::string numbers(const CaseOutcome& o) {
  if (!o.finite) return "NaN for good";
  return text("%.2f, %.0f, %.1f", o.step_N, o.speed_mm_s, o.energy_mJ);
}

}  // namespace

void stabilityCases(const StabilityReport& to) {
  std::vector<ExtremeCase> all = planeCases();
  for (const ExtremeCase& more : roomCases()) all.push_back(more);
  std::vector<std::vector<std::string>> lines{{"case", "naive: step N, hand mm/s, mJ", "chain",
                                               "unexplained step N", "peak, end N",
                                               "what the chain did"}};
  double excess_N = 0.0;
  std::size_t broken = 0;
  for (const ExtremeCase& c : all) {
    const CaseOutcome& o = c.chain;
    lines.push_back({c.name, numbers(c.naive), numbers(o), text("%g", o.excess_N),
                     text("%.2f, %.2f", o.peak_N, o.end_N), namesOf(o.interferences)});
    std::string name = c.name;
    std::replace(name.begin(), name.end(), ',', ';');
    to.report.add({name, "extreme_energy", "naive", c.naive.energy_mJ, "mJ"});
    to.report.add({name, "extreme_energy", "chain", o.energy_mJ, "mJ", 0.0, true});
    excess_N = std::max(excess_N, o.excess_N);
    broken += !o.finite || o.peak_N > c.allowed_N + 1e-9;
  }
  to.claims.add(text("%zu extreme cases: step beyond what the hand explains", all.size()), "0 N",
                text("%g N", excess_N), excess_N == 0.0);
  to.claims.add("the same: cases with a force that is not finite or above the peak", "0",
                text("%zu", broken), broken == 0);
  to.report.say(
      "### Extreme cases\n\nd 1, friction 0.05 N, light hand; K 1 at the wall, the "
      "device's own 0.5 N/mm in the room (frames in, force out). Each cell: largest step "
      "of the force in a tick, speed of the hand away from the surface, most energy into "
      "the hand. A step that remains with the chain is the hand's own motion.\n\n" +
      markdown(lines));
}

}  // namespace hapticast::evaluate
