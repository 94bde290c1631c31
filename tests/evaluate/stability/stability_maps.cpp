// SPDX-License-Identifier: MIT
// Maps of the bare wall F = max(0, K d + B u): what is left of an impact over stiffness, damping,
// delay, counts and hands, with the line of theory and the chain's own law drawn in.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

constexpr double kPhysicalDamping_Ns_m = 0.1;

struct Axes {
  std::vector<double> stiffness_N_mm;  // evenly spaced in the logarithm
  std::vector<double> damping_Ns_m;
  std::vector<int> delays;
  std::vector<double> counts_mm{0.0, 0.038, 0.055};

  /// Where a damping lies between the rows.
  [[nodiscard]] double row(double damping) const {
    for (std::size_t i = 1; i < damping_Ns_m.size(); ++i) {
      const double from = damping_Ns_m[i - 1];
      if (damping <= damping_Ns_m[i])
        return double(i) - 1.0 + (damping - from) / (damping_Ns_m[i] - from);
    }
    return double(damping_Ns_m.size());
  }
};

struct MapCell {
  double stiffness_N_mm, damping_Ns_m, count_mm;
  int delay;
  const NamedHand* hand;
  double residual_mm = 0.0;
  double work_mJ = 0.0;
};

Axes axesOf(bool quick) {
  Axes axes;
  const int steps = quick ? 7 : 16;
  for (int i = 0; i < steps; ++i)
    axes.stiffness_N_mm.push_back(0.1 * std::pow(200.0, i / double(steps - 1)));
  axes.damping_Ns_m = quick ? std::vector<double>{0, 1, 2, 5, 10, 20, 50}
                            : std::vector<double>{0, 0.5, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50};
  axes.delays = quick ? std::vector<int>{0, 1, 2, 5} : std::vector<int>{0, 1, 2, 3, 4, 5};
  if (quick) axes.counts_mm = {0.0, 0.055};
  return axes;
}

void run(MapCell& c) {
  PlantProfile profile = sweepProfile(c.stiffness_N_mm, c.delay);
  profile.damping_Ns_m = kPhysicalDamping_Ns_m;
  DeviceProfile assumed = profile;  // a filter needs some count; without them a fine one
  assumed.count_mm = c.count_mm > 0.0 ? c.count_mm : 0.001;
  profile.count_mm = c.count_mm;
  ChainFixture rig(assumed, profile, c.hand->hand);
  rig.by_counts = true;
  rig.law = bareLaw(c.damping_Ns_m, profile.peak_N);
  const SweepResult result = sweepPlant(rig, c.hand->hand, true);
  c.residual_mm = result.residual_mm;
  c.work_mJ = result.work_mJ;
}

constexpr const char* kResidualPalette =
    "set palette defined (-1 '#1a7f3c', 0.30 '#a6d96a', 0.301 '#ffffbf', 1 '#fdae61', 2 '#d7191c', "
    "3 '#5c0010')\nset cbrange [-1:3]\nset cbtics ('0.1' -1, '2' 0.301, '10' 1, '100' 2, '1000' "
    "3)\n";
constexpr const char* kWorkPalette =
    "set palette defined (-2 '#2166ac', 0 '#f7f7f7', 1 '#fddbc7', 2 '#d6604d', 4 '#67001f')\n"
    "set cbrange [-2:4]\nset cbtics ('-100' -2, '-10' -1, '0' 0, '10' 1, '100' 2, '1000' 3, '10^4' "
    "4)\n";

/// Sign and logarithm of a work in mJ: -100, -10, within 1, 10, ...
double logOf(double work_mJ) {
  return work_mJ == 0.0 ? 0.0
                        : std::copysign(std::log10(std::max(1.0, std::abs(work_mJ))), work_mJ);
}

struct Line {
  std::string name;
  std::function<bool(const MapCell&)> shown;
};

/// Panels: a line for each of `rows`, a column for each delay.
void draw(const StabilityReport& to, const Axes& axes, const std::vector<MapCell>& cells,
          const std::string& name, const std::string& title, bool work,
          const std::vector<Line>& rows) {
  std::ostringstream out;
  out << "set terminal pngcairo enhanced size " << 250 * axes.delays.size() + 150 << ','
      << 215 * rows.size() + 110 << " font 'sans,10'\nset output '" << name
      << ".png'\nset multiplot layout " << rows.size() << ',' << axes.delays.size() << " title \""
      << title << "\" font 'sans,13' margins 0.075,0.91,0.09,0.90 spacing 0.012,0.035\n"
      << (work ? kWorkPalette : kResidualPalette)
      << "set key off\nset xtics ('0.1' -1, '0.5' -0.301, '1' 0, '2' 0.301, '5' 0.699, '20' "
         "1.301) font ',9'\n";
  const double half_x = 0.5 * std::log10(axes.stiffness_N_mm[1] / axes.stiffness_N_mm[0]);
  out << "set xrange [" << -1 - half_x << ':' << 1.301 + half_x
      << "]\nset yrange [-0.5:" << double(axes.damping_Ns_m.size()) - 0.5 << "]\nunset colorbox\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t d = 0; d < axes.delays.size(); ++d) {
      const int delay = axes.delays[d];
      out << "$map << EOD\n";
      for (const MapCell& c : cells) {
        if (c.delay != delay || !rows[r].shown(c)) continue;
        const double counts = c.residual_mm / 0.055;
        out << std::log10(c.stiffness_N_mm) << ' ' << axes.row(c.damping_Ns_m) << ' '
            << (work ? logOf(c.work_mJ) : std::log10(std::max(0.1, counts))) << '\n';
      }
      out << "EOD\n$theory << EOD\n";
      for (double k = 0.1; k <= 20.0; k *= 1.05) {
        const double B = k * (0.5 + delay) - kPhysicalDamping_Ns_m;
        if (B >= 0.0 && B <= axes.damping_Ns_m.back())
          out << std::log10(k) << ' ' << axes.row(B) << '\n';
      }
      out << "EOD\n$law << EOD\n";
      const double most = stiffnessLimit_N_mm(0.045, delay);
      for (double k = 0.1; k <= most; k *= 1.02) {
        out << std::log10(k) << ' ' << axes.row(wallDamping_Ns_m(k, kOmniMass_kg, most)) << '\n';
      }
      out << "EOD\n";
      if (d == 0) {
        out << "set ylabel \"" << rows[r].name << "\\nB, N s/m\"\nset ytics (";
        for (std::size_t i = 0; i < axes.damping_Ns_m.size(); i += 1)
          out << (i > 0 ? ", " : "") << "'" << axes.damping_Ns_m[i] << "' " << i;
        out << ") font ',8'\n";
      } else {
        out << "unset ylabel\nunset ytics\n";
      }
      out << (r + 1 == rows.size() ? "set xlabel 'K, N/mm'\nset format x '%g'\n"
                                   : "unset xlabel\n");
      out << (r == 0 ? text("set title 'delay %d'\n", delay) : std::string("unset title\n"));
      const bool last = r == 0 && d + 1 == axes.delays.size();
      if (last) out << "set colorbox user origin 0.925,0.15 size 0.015,0.7\n";
      out << "plot $map with image, $theory with lines lw 2.5 lc rgb 'black', $law with lines lw "
             "2.5 dt (6,4) lc rgb '#1030ff'\n";
      if (last) out << "unset colorbox\n";
    }
  }
  out << "unset multiplot\n";
  gnuplot(to.options.out, name, out.str());
}

void writeCells(const StabilityReport& to, const std::vector<MapCell>& cells) {
  std::ofstream file(to.options.out / "stability_map.csv");
  file << "hand,delay_ticks,count_mm,stiffness_N_mm,damping_Ns_m,residual_counts,work_mJ\n";
  for (const MapCell& c : cells) {
    file << c.hand->name << ',' << c.delay << ',' << c.count_mm << ',' << c.stiffness_N_mm << ','
         << c.damping_Ns_m << ',' << c.residual_mm / 0.055 << ',' << c.work_mJ << '\n';
  }
}

}  // namespace

void stabilityMaps(const StabilityReport& to) {
  const Axes axes = axesOf(to.options.quick);
  std::vector<MapCell> cells;
  for (const NamedHand& hand : kHands) {
    if (to.options.quick && (hand.name == std::string("light") || hand.name == std::string("firm")))
      continue;
    for (const int d : axes.delays) {
      for (const double count_mm : axes.counts_mm) {
        for (const double b : axes.damping_Ns_m) {
          for (const double k : axes.stiffness_N_mm) cells.push_back({k, b, count_mm, d, &hand});
        }
      }
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) { run(cells[i]); });
  writeCells(to, cells);

  std::vector<Line> hands;
  for (const NamedHand& hand : kHands) {
    if (std::none_of(cells.begin(), cells.end(), [&](const MapCell& c) { return c.hand == &hand; }))
      continue;
    hands.push_back(
        {hand.name, [&hand](const MapCell& c) { return c.hand == &hand && c.count_mm == 0.055; }});
  }
  std::vector<Line> counts;
  for (const double count_mm : axes.counts_mm) {
    counts.push_back({text("count %g mm", count_mm), [count_mm](const MapCell& c) {
                        return c.hand == &kHands.back() && c.count_mm == count_mm;
                      }});
  }
  draw(to, axes, cells, "stability",
       "Bare wall F = max(0, Kd + Bu): what is left of an impact, counts of 0.055 mm (green: 2 at "
       "most)\\nblack: K = (b+B)/(T/2+td); blue: the chain's B = K tau + 1 up to K_{max}",
       false, hands);
  draw(to, axes, cells, "stability_energy",
       "The same: work into the hand over the contact, mJ (blue: the wall swallows, red: it "
       "gives)",
       true, hands);
  draw(to, axes, cells, "stability_counts",
       "The same without a hand, for counts of 0, 0.038 and 0.055 mm", false, counts);
}

}  // namespace hapticast::evaluate
