// SPDX-License-Identifier: MIT
#include "tests/evaluate/curves.hpp"

#include <algorithm>
#include <sstream>

#include "tests/evaluate/gnuplot.hpp"

namespace hapticast::evaluate {

namespace {

void writeRange(std::ostream& file, const char* axis, double from, double to) {
  if (from < to)
    file << "set " << axis << "range [" << from << ':' << to << "]\n";
  else
    file << "set autoscale " << axis << "\n";
}

void writePanel(std::ostream& file, const CurvePanel& panel, std::size_t index) {
  std::ostringstream curves;
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    const std::string id = "$c" + std::to_string(index) + "_" + std::to_string(i);
    file << id << " << EOD\n";
    for (const CurvePoint& p : curve.points)
      file << p.x << ' ' << p.y << ' ' << p.dx << ' ' << p.dy << '\n';
    file << "EOD\n";
    curves << (i > 0 ? ", " : "") << id
           << (curve.arrows ? " using 1:2:3:4 with vectors head size 0.35,20 filled"
                            : " using 1:2 with lines")
           << " lw " << curve.width << (curve.dashed ? " dt 2" : "") << " lc rgb '" << curve.color
           << "' " << (curve.name.empty() ? "notitle" : "title '" + curve.name + "'");
  }
  file << "set title '" << panel.title << "'\nset xlabel '" << panel.x_label << "'\nset ylabel '"
       << panel.y_label << "'\n"
       << (panel.same_scale ? "set size ratio -1\n" : "set size noratio\n");
  writeRange(file, "x", panel.left, panel.right);
  writeRange(file, "y", panel.low, panel.high);
  file << "plot " << curves.str() << "\n";
}

}  // namespace

void shareScale(std::vector<CurvePanel>& panels) {
  double low = 0;
  double high = 0;
  for (const CurvePanel& panel : panels) {
    for (const Curve& curve : panel.curves) {
      for (const CurvePoint& p : curve.points) {
        low = std::min(low, p.y);
        high = std::max(high, p.y);
      }
    }
  }
  const double margin = 0.05 * (high - low);
  for (CurvePanel& panel : panels) {
    panel.low = low - margin;
    panel.high = high + margin;
  }
}

void plotCurves(const std::filesystem::path& png, const std::vector<CurvePanel>& panels,
                std::size_t columns) {
  std::ostringstream file;
  const std::size_t lines = (panels.size() + columns - 1) / columns;
  file << "set terminal pngcairo noenhanced size " << 640 * columns << ',' << 360 * lines
       << " font 'sans,11'\nset output '" << png.filename().string() << "'\nset multiplot layout "
       << lines << ',' << columns
       << "\nset grid lc rgb '#d8d8d8'\nset key outside top center horizontal\n";
  for (std::size_t i = 0; i < panels.size(); ++i) writePanel(file, panels[i], i);
  file << "unset multiplot\n";
  gnuplot(png.parent_path(), png.stem().string(), file.str());
}

}  // namespace hapticast::evaluate
