// SPDX-License-Identifier: MIT
// The table of extreme cases.
#include "tests/evaluate/stability/stability_cases.hpp"

#include <algorithm>
#include <sstream>

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

std::string listNames(std::uint32_t safety_actions) {
  std::string all;
  for (std::size_t i = 0; i < client::kSafetyActionNames.size(); ++i) {
    if (((safety_actions >> i) & 1U) == 0) continue;
    all += (all.empty() ? "" : " ") + std::string(client::kSafetyActionNames[i]);
  }
  return all.empty() ? "nothing had to be done" : all;
}

std::string numbers(const CaseOutcome& o) {
  if (!o.finite) return "NaN for good";
  return text("%.2f, %.0f, %.1f", o.step_N, o.speed_mm_s, o.energy_mJ);
}

/// Force and speed over time of some of them, naive loop and chain.
void draw(const StabilityReport& to, const std::vector<ExtremeCase>& all) {
  const struct {
    const char* name;
    int ticks;
  } shown[] = {{"surface appears 30 mm above the tip", 400},
               {"30 mm rise within one frame of 40 ms", 400},
               {"stall of 0.5 s, then +20 mm", 1000},
               {"tip at 2 m/s into the wall", 200},
               {"a 30 mm step in one pixel, slid across at 24 mm/s", 1000},
               {"disconnect in contact, reconnect to a scene 3 mm higher", 1500}};
  std::ostringstream out;
  out << "set terminal pngcairo noenhanced size 1500,820 font 'sans,10'\nset output "
         "'stability_cases.png'\nset multiplot layout 2,3\nset grid lc rgb '#e0e0e0'\nset xlabel "
         "'ms since the event'\nset ylabel 'force, N (full)'\nset y2label 'tip upwards, mm/s "
         "(dashed)'\nset ytics nomirror\nset y2tics\nset yrange [0:3.6]\nset key above\n";
  for (const auto& [name, ticks] : shown) {
    for (const ExtremeCase& c : all) {
      if (c.name != name) continue;
      for (const bool naive : {true, false}) {
        const CaseOutcome& o = naive ? c.naive : c.chain;
        out << (naive ? "$naive" : "$chain") << " << EOD\n";
        for (std::size_t i = 0; i < std::min<std::size_t>(std::size_t(ticks), o.trace_N.size());
             ++i)
          out << i << ' ' << o.trace_N[i] << ' ' << o.trace_mm_s[i] << '\n';
        out << "EOD\n";
      }
      out << "set title \"" << c.name
          << "\"\nplot $naive using 1:3 axes x1y2 with lines dt 2 lw 1.5 lc rgb '#f4a582' notitle, "
             "$chain "
             "using 1:3 axes x1y2 with lines dt 2 lw 1.5 lc rgb '#6baed6' notitle, $naive using "
             "1:2 with "
             "lines lw 2 lc rgb '#ca0020' title 'naive', $chain using 1:2 with lines lw 2 lc rgb "
             "'#0571b0' title 'chain'\n";
    }
  }
  gnuplot(to.options.out, "stability_cases", out.str() + "unset multiplot\n");
}

}  // namespace

void stabilityCases(const StabilityReport& to) {
  std::vector<ExtremeCase> all = planeCases();
  for (const ExtremeCase& more : rendererCases()) all.push_back(more);
  Table lines{{"case", "naive: step N, hand mm/s, mJ", "chain: the same", "unexplained step N",
               "peak, end N", "what the chain did"}};
  double excess_N = 0.0;
  std::size_t broken = 0;
  for (const ExtremeCase& c : all) {
    const CaseOutcome& o = c.chain;
    lines.push_back({c.name, numbers(c.naive), numbers(o), text("%g", o.excess_N),
                     text("%.2f, %.2f", o.peak_N, o.end_N), listNames(o.safety_actions)});
    std::string name = c.name;
    std::replace(name.begin(), name.end(), ',', ';');
    to.report.add({name, "extreme_energy", "naive", c.naive.energy_mJ, "mJ"});
    to.report.add({name, "extreme_energy", "chain", o.energy_mJ, "mJ", 0.0, true});
    excess_N = std::max(excess_N, o.excess_N);
    broken += !o.finite || o.peak_N > c.allowed_N + 1e-9;
  }
  to.report.require(text("%zu extreme cases: step beyond what the hand explains", all.size()),
                    "0 N", text("%g N", excess_N), excess_N == 0.0);
  to.report.require("extreme cases with a force that is not finite or above the peak", "0",
                    text("%zu", broken), broken == 0);
  const std::vector<std::string> unexpected = findUnexpectedForces();
  to.report.require(
      "extreme cases at walls of 0.5, 1 and 5 N/mm whose force leaves the limits of the case", "0",
      text("%zu (%s)", unexpected.size(), unexpected.empty() ? "-" : unexpected.front().c_str()),
      unexpected.empty());
  to.report.addTable("cases", lines);
  draw(to, all);
}

}  // namespace hapticast::evaluate