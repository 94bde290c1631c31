// SPDX-License-Identifier: MIT
#include "tests/evaluate/report_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "tests/evaluate/gnuplot.hpp"

namespace hapticast::evaluate {

namespace {

constexpr double kFloor = 1e-4;        // of the largest error of a panel
constexpr std::size_t kManyNames = 6;  // more stand beside their panel, not over it
// Apart from each other also for who does not see red or green (after Tol's and Okabe's palettes).
constexpr std::array<const char*, 12> kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#882255", "#332288",
                                              "#999933", "#44aa99", "#661100", "#aaaaaa"};

struct Point {
  double time = 0, error = 0;
};

struct Variant {
  std::string name;
  bool is_default = false, is_thesis = false;
  std::vector<Point> scenes;

  [[nodiscard]] Point mean() const {
    Point sum;
    for (const Point& p : scenes) {
      sum.time += std::log(p.time) / double(scenes.size());
      sum.error += std::log(p.error) / double(scenes.size());
    }
    return {std::exp(sum.time), std::exp(sum.error)};
  }
};

struct Panel {
  std::string stage, unit;
  std::vector<Variant> variants;
};

// Means and worst cases are rows of the table, not measurements.
bool isSummary(const Row& row) { return row.scene == "worst" || row.scene.rfind("mean", 0) == 0; }

template <typename T, typename Is>
T& findOrAdd(std::vector<T>& all, T fresh, Is is) {
  const auto known = std::find_if(all.begin(), all.end(), is);
  if (known != all.end()) return *known;
  all.push_back(std::move(fresh));
  return all.back();
}

double largestError(const Panel& panel) {
  double largest = 0;
  for (const Variant& variant : panel.variants) {
    for (const Point& p : variant.scenes) largest = std::max(largest, p.error);
  }
  return largest;
}

// Values that are nearly exact are drawn at the lower edge: rounding errors are not worth decades.
void raiseToFloor(Panel& panel) {
  const double largest = largestError(panel);
  for (Variant& variant : panel.variants) {
    for (Point& p : variant.scenes) p.error = std::max(p.error, kFloor * largest);
  }
}

std::vector<Panel> panelsOf(const std::vector<Row>& rows, double us_per_unit) {
  std::vector<Panel> panels;
  for (const Row& row : rows) {
    if (row.time_us <= 0 || !(row.error >= 0) || isSummary(row)) continue;
    Panel& panel = findOrAdd(panels, Panel{row.stage, row.unit, {}},
                             [&](const Panel& p) { return p.stage == row.stage; });
    Variant& variant =
        findOrAdd(panel.variants, Variant{row.variant, row.is_default, row.is_thesis, {}},
                  [&](const Variant& v) { return v.name == row.variant; });
    variant.scenes.push_back({row.time_us / us_per_unit, row.error});
  }
  std::erase_if(panels, [](const Panel& panel) { return largestError(panel) <= 0; });
  for (Panel& panel : panels) raiseToFloor(panel);
  return panels;
}

// Those that no other beats in time and error, by time.
std::vector<Point> decodeFirst(const std::vector<Variant>& variants) {
  std::vector<Point> means;
  means.reserve(variants.size());
  for (const Variant& variant : variants) means.push_back(variant.mean());
  std::sort(means.begin(), means.end(),
            [](const Point& a, const Point& b) { return a.time < b.time; });
  std::vector<Point> front;
  for (const Point& point : means) {
    if (front.empty() || point.error < front.back().error) front.push_back(point);
  }
  return front;
}

void writeData(std::ostream& file, const std::string& name, const std::vector<Point>& points) {
  file << '$' << name << " << EOD\n";
  for (const Point& p : points) file << number(p.time) << ' ' << number(p.error) << '\n';
  file << "EOD\n";
}

// The color of a variant is the same in all panels of a topic.
using Names = std::vector<std::string>;
Names listNames(const std::vector<Panel>& panels) {
  Names out;
  for (const Panel& panel : panels) {
    for (const Variant& variant : panel.variants)
      findOrAdd(out, variant.name, [&](const std::string& name) { return name == variant.name; });
  }
  return out;
}

void writePanel(std::ostream& file, const Panel& panel, std::size_t index, const Names& names) {
  std::ostringstream curves;
  const std::string id = std::to_string(index) + "_";
  double left = 1e300, right = 0, low = 1e300, high = 0;
  for (const Variant& variant : panel.variants) {
    for (const Point& p : variant.scenes) {
      left = std::min(left, p.time);
      right = std::max(right, p.time);
      low = std::min(low, p.error);
      high = std::max(high, p.error);
    }
  }
  writeData(file, "front" + id, decodeFirst(panel.variants));
  curves << "$front" << id << " with lines lw 2 dt 2 lc rgb '#808080' title 'best for its time'";
  for (std::size_t i = 0; i < panel.variants.size(); ++i) {
    const Variant& variant = panel.variants[i];
    const std::string scenes = "s" + id + std::to_string(i);
    const std::string mean = "m" + id + std::to_string(i);
    const auto name = std::find(names.begin(), names.end(), variant.name) - names.begin();
    const std::string color =
        std::string(" lc rgb '") + kColors[std::size_t(name) % kColors.size()] + "'";
    writeData(file, scenes, variant.scenes);
    writeData(file, mean, {variant.mean()});
    const bool says_so = variant.name == "thesis";
    const char* mark = variant.is_default              ? " (default)"
                       : variant.is_thesis && !says_so ? " (thesis)"
                                                       : "";
    curves << ", $" << scenes << " with points pt 7 ps 0.4" << color << " notitle, $" << mean
           << " with points pt " << (variant.is_thesis ? "2 lw 3 ps 2.2" : "7 ps 1.7") << color
           << " title '" << variant.name << mark << "'";
    if (variant.is_default)
      curves << ", $" << mean << " with points pt 6 lw 2 ps 3.2 lc rgb 'black' notitle";
  }
  file << "set key outside "
       << (panel.variants.size() > kManyNames
               ? "right center vertical maxcols 1 font ',8' spacing 0.95"
               : "top center horizontal maxcols 0 font ',11' spacing 1")
       << "\nset title '" << panel.stage << "'\nset ylabel '" << panel.unit << "'\nset xrange ["
       << number(left / 1.5) << ':' << number(right * 1.5) << "]\nset yrange [" << number(low / 1.6)
       << ':' << number(high * 1.6) << "]\nplot " << curves.str() << "\n";
}

}  // namespace

std::string number(double value) { return text("%.4g", value); }

void plotRows(const std::string& topic, const std::filesystem::path& out,
              const std::vector<Row>& rows, bool of_ticks) {
  const std::vector<Panel> panels = panelsOf(rows, of_ticks ? 1.0 : 1e3);
  if (panels.empty()) return;
  std::ostringstream file;
  const std::size_t columns = panels.size() > 1 ? 2 : 1;
  const std::size_t lines = (panels.size() + columns - 1) / columns;
  file << "set terminal pngcairo noenhanced size " << 760 * columns << ',' << 420 * lines
       << " font 'sans,11'\nset output '" << topic << ".png'\nset multiplot layout " << lines << ','
       << columns << "\nset logscale xy\nset format y '%.3g'\nset format x '%.3g'\n"
       << "set xtics add (0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200)\n"
       << "set grid lc rgb '#d0d0d0'\n"
       << "set xlabel 'run time, " << (of_ticks ? "us per tick" : "ms of one thread per frame")
       << "'\n";
  const Names names = listNames(panels);
  for (std::size_t i = 0; i < panels.size(); ++i) writePanel(file, panels[i], i, names);
  file << "unset multiplot\n";
  gnuplot(out, topic, file.str());
}

}  // namespace hapticast::evaluate
