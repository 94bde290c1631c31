// SPDX-License-Identifier: MIT
// Plain curves and arrows, drawn by gnuplot into one picture of several panels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace hapticast::evaluate {

struct CurvePoint {
  double x = 0.0, y = 0.0;
  double dx = 0.0, dy = 0.0;  ///< of an arrow that begins there
};

struct Curve {
  std::string name;   ///< empty: not in the key
  std::string color;  ///< #rrggbb
  std::vector<CurvePoint> points;
  double width = 1.5;
  bool dashed = false;
  bool arrows = false;
};

struct CurvePanel {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool same_scale = false;         ///< on both axes
  double left = 0.0, right = 0.0;  ///< x range; both 0: as it comes
  double low = 0.0, high = 0.0;    ///< y range
};

/// The same y range for all: panels that stand side by side are to be compared.
void shareScale(std::vector<CurvePanel>& panels);

/// Panels row by row. Says where there is no gnuplot.
void plotCurves(const std::filesystem::path& png, const std::vector<CurvePanel>& panels,
                std::size_t columns);

}  // namespace hapticast::evaluate
