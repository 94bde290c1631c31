// SPDX-License-Identifier: MIT
#include "server/vision/motion/grid.hpp"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/flow.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

constexpr int kSampleStep_px = 8;     // chosen: four points for each cell
constexpr int kWindowMargin_px = 16;  // chosen: margin for the tracking windows

struct Cell {
  std::array<std::vector<double>, 3> steps;
};

// Returns the points of `mask` to track, `step_px` apart.
std::vector<cv::Point> makeSampleLattice(const cv::Mat& mask, int step_px = kSampleStep_px) {
  std::vector<cv::Point> out;
  for (int v = step_px / 2; v < mask.rows; v += step_px) {
    for (int u = step_px / 2; u < mask.cols; u += step_px) {
      if (mask.at<unsigned char>(v, u) != 0) out.emplace_back(u, v);
    }
  }
  return out;
}

// Returns the index of the cell that contains a pixel of the box. Cells have kGridCell_px, or
// `reduction` times as many.
std::size_t cellIndex(const cv::Point& in_box, const CellFlow& flow, int reduction = 1) {
  const int cell_px = reduction * kGridCell_px;
  return static_cast<std::size_t>(in_box.y / cell_px * flow.columns + in_box.x / cell_px);
}

void addTracks(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
               const Surface& now, const CellFlow& flow, std::vector<Cell>& cells) {
  std::vector<cv::Point2f> points;
  for (const cv::Point& at : makeSampleLattice(last_mask)) points.emplace_back(at);
  const PointTracks tracks = trackPoints(last_gray, gray, points, points);
  for (std::size_t i = 0; i < tracks.from.size(); ++i) {
    const cv::Point2f& from = tracks.from[i];
    const cv::Point2f& to = tracks.to[i];
    const int column = (static_cast<int>(to.x) - now.box.x) / kGridCell_px;
    const int row = (static_cast<int>(to.y) - now.box.y) / kGridCell_px;
    if (column < 0 || row < 0 || column >= flow.columns || row >= flow.rows) continue;
    Cell& cell = cells[static_cast<std::size_t>(row * flow.columns + column)];
    cell.steps[0].push_back(double(to.x - from.x));
    cell.steps[1].push_back(double(to.y - from.y));
  }
}

// Depth differences at one pixel: the thesis's z-only case ignores motion in the plane.
void addDepths(const Surface& before, const Surface& now, const CellFlow& flow,
               std::vector<Cell>& cells) {
  const cv::Rect common = before.box & now.box;
  for (int v = common.y; v < common.br().y; ++v) {
    for (int u = common.x; u < common.br().x; ++u) {
      const cv::Point there = cv::Point(u, v) - before.box.tl();
      const cv::Point here = cv::Point(u, v) - now.box.tl();
      if (before.measured.at<unsigned char>(there) == 0 ||
          now.measured.at<unsigned char>(here) == 0)
        continue;
      cells[cellIndex(here, flow)].steps[2].push_back(double(now.depth.at<float>(here)) -
                                                      double(before.depth.at<float>(there)));
    }
  }
}

CellFlow makeCells(const cv::Rect& box) {
  CellFlow out;
  out.columns = gridCells(box.width);
  out.rows = gridCells(box.height);
  return out;
}

// A cell without a measurement is 0 if `known` (no residual), else the median of all cells.
cv::Mat computeMedians(std::vector<Cell>& cells, const CellFlow& size, bool known) {
  std::array<cv::Mat, 3> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> all;
    for (const Cell& cell : cells)
      all.insert(all.end(), cell.steps[axis].begin(), cell.steps[axis].end());
    axes[axis].create(size.rows, size.columns, CV_32F);
    axes[axis].setTo(known ? 0.0 : computeMedian(all));
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].steps[axis].empty()) continue;
      const int index = static_cast<int>(i);
      axes[axis].at<float>(index / size.columns, index % size.columns) =
          static_cast<float>(computeMedian(cells[i].steps[axis]));
    }
    cv::medianBlur(axes[axis], axes[axis], 3);
  }
  cv::Mat out;
  cv::merge(axes.data(), 3, out);
  return out;
}

cv::Vec3f sampleFlow(const CellFlow& flow, double x, double y) {
  const int column = std::clamp(static_cast<int>(x * flow.columns), 0, flow.columns - 1);
  const int row = std::clamp(static_cast<int>(y * flow.rows), 0, flow.rows - 1);
  return flow.step.at<cv::Vec3f>(row, column);
}

// Returns the mean velocity, per second, over flows first .. last at a place (0..1) in the box.
cv::Vec3d meanVelocity(const std::vector<const CellFlow*>& flows, std::size_t first,
                       std::size_t last, double x, double y) {
  cv::Vec3d sum(0, 0, 0);
  double time_s = 0;
  for (std::size_t i = first; i <= last; ++i) {
    if (flows[i]->columns == 0) continue;
    sum += cv::Vec3d(sampleFlow(*flows[i], x, y));
    time_s += flows[i]->interval_s;
  }
  return time_s > 0 ? sum / time_s : cv::Vec3d(0, 0, 0);
}

}  // namespace

CellFlow CellFlow::atRest() const {
  CellFlow out = *this;
  if (step.empty()) return out;
  // Assigning an expression to a Mat of equal size would write into shared data; hence a new Mat.
  const cv::Mat none = cv::Mat::zeros(step.size(), step.type());
  out.step = none;
  return out;
}

CellFlow cellFlow(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& last_mask,
                  const Surface& before, const Surface& now, MotionMode mode) {
  CellFlow out = makeCells(now.box);
  std::vector<Cell> cells(static_cast<std::size_t>(out.columns * out.rows));
  if (mode != MotionMode::kDepth) addTracks(last_gray, gray, last_mask, now, out, cells);
  if (mode != MotionMode::kLk) addDepths(before, now, out, cells);
  out.step = computeMedians(cells, out, /*known=*/false);
  return out;
}

namespace {

// Two pictures reduced around an object, and the way between their places and the picture's.
struct ReducedPair {
  cv::Rect area;  // px of the picture
  int reduction = 1;
  cv::Mat last, now;

  ReducedPair(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Rect& around, int by)
      : area(around.tl(), around.size() / by * by), reduction(by) {
    last = last_gray(area);
    now = gray(area);
    if (by == 1) return;
    cv::resize(last, last, area.size() / by, 0, 0, cv::INTER_AREA);
    cv::resize(now, now, area.size() / by, 0, 0, cv::INTER_AREA);
  }
  [[nodiscard]] cv::Point2f toReduced(const cv::Point2f& at) const {
    return (at - cv::Point2f(area.tl()) - middle()) / static_cast<float>(reduction);
  }
  [[nodiscard]] cv::Point2f toPicture(const cv::Point2f& at) const {
    return static_cast<float>(reduction) * at + middle() + cv::Point2f(area.tl());
  }

 private:
  // The middle of a block of pixels.
  [[nodiscard]] cv::Point2f middle() const {
    const float half = 0.5F * static_cast<float>(reduction - 1);
    return {half, half};
  }
};

// Interpolates the steps between the middles of cells that are `reduction` times as large.
cv::Mat interpolateSteps(const cv::Mat& large, int reduction, const CellFlow& cells) {
  if (reduction == 1) return large;
  cv::Mat out;
  cv::resize(large, out, large.size() * reduction, 0, 0, cv::INTER_LINEAR);
  return out(cv::Rect(0, 0, cells.columns, cells.rows)).clone();
}

// Adds the residual steps of a lattice of points to the cells of `size`.
void addResiduals(const ReducedPair& pair, const Surface& before, const Surface& now,
                  const PredictedMotion& explained, const CellFlow& size,
                  std::vector<Cell>& cells) {
  std::vector<cv::Point2f> points;
  std::vector<cv::Point2f> guesses;
  for (const cv::Point& in_box : makeSampleLattice(before.mask, pair.reduction * kSampleStep_px)) {
    const cv::Point2f at = cv::Point2f(before.box.tl() + in_box);
    const cv::Vec3d step = explained(at, double(before.depth.at<float>(in_box)));
    points.push_back(pair.toReduced(at));
    guesses.push_back(points.back() + cv::Point2f(float(step[0]), float(step[1])) /
                                          static_cast<float>(pair.reduction));
  }
  const PointTracks tracks = trackPoints(pair.last, pair.now, points, guesses);
  for (std::size_t i = 0; i < tracks.from.size(); ++i) {
    const cv::Point2f was = pair.toPicture(tracks.from[i]);
    const cv::Point2f is = pair.toPicture(tracks.to[i]);
    const cv::Point here = cv::Point(cvRound(is.x), cvRound(is.y)) - now.box.tl();
    if (!cv::Rect({0, 0}, now.box.size()).contains(here) || now.mask.at<unsigned char>(here) == 0)
      continue;
    const auto depth_mm = double(before.depth.at<float>(cv::Point(was) - before.box.tl()));
    const cv::Vec3d step = explained(was, depth_mm);
    const cv::Point2f moved = pair.reduction * (tracks.to[i] - tracks.from[i]);
    Cell& cell = cells[cellIndex(here, size, pair.reduction)];
    cell.steps[0].push_back(double(moved.x) - step[0]);
    cell.steps[1].push_back(double(moved.y) - step[1]);
    cell.steps[2].push_back(double(now.depth.at<float>(here)) - depth_mm - step[2]);
  }
}

}  // namespace

CellFlow residualFlow(const cv::Mat& last_gray, const cv::Mat& gray, const Surface& before,
                      const Surface& now, const PredictedMotion& explained) {
  const ReducedPair pair(
      last_gray, gray,
      growRect(before.box | now.box, now.reduction * kWindowMargin_px, last_gray.size()),
      now.reduction);
  CellFlow large;
  large.columns = (gridCells(now.box.width) + now.reduction - 1) / now.reduction;
  large.rows = (gridCells(now.box.height) + now.reduction - 1) / now.reduction;
  std::vector<Cell> cells(static_cast<std::size_t>(large.columns * large.rows));
  addResiduals(pair, before, now, explained, large, cells);
  CellFlow out = makeCells(now.box);
  out.step = interpolateSteps(computeMedians(cells, large, /*known=*/true), now.reduction, out);
  return out;
}

CellFlow measureCells(const CellInput& input, const Surface& now, const CellFlow& last,
                      MotionMode mode) {
  if (input.kind == CellInput::Kind::kRest) return last.atRest();
  CellFlow out;
  if (input.kind == CellInput::Kind::kWhole)
    out = cellFlow(input.last_gray, input.gray, input.last_mask, input.before, now, mode);
  if (input.kind == CellInput::Kind::kResidual)
    out = residualFlow(input.last_gray, input.gray, input.before, now, input.explained);
  out.interval_s = input.interval_s;
  return out;
}

std::shared_ptr<const MotionGrid> makeMotionGrid(const std::vector<const CellFlow*>& flows,
                                                 std::size_t at, const Vec3& mm_per_step) {
  const CellFlow& here = *flows[at];
  if (here.columns == 0) return nullptr;
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = here.columns;
  grid->rows = here.rows;
  const std::size_t reach = std::min(at + 1, flows.size() - 1 - at);
  const std::size_t after = std::min(at + 1, flows.size() - 1);
  for (int row = 0; row < here.rows; ++row) {
    for (int column = 0; column < here.columns; ++column) {
      const double x = (column + 0.5) / here.columns;
      const double y = (row + 0.5) / here.rows;
      cv::Vec3d velocity = meanVelocity(flows, at, after, x, y);
      cv::Vec3d acceleration(0, 0, 0);
      if (reach > 0) {
        const cv::Vec3d early = meanVelocity(flows, at + 1 - reach, at, x, y);
        const cv::Vec3d late = meanVelocity(flows, at + 1, at + reach, x, y);
        const double apart_s = double(reach) * flows[at + 1]->interval_s;
        if (apart_s > 0) acceleration = (late - early) / apart_s;
      }
      const auto nominal = [&](const cv::Vec3d& step) {
        return Eigen::Vector3f(float(step[0] * mm_per_step.x()), float(step[1] * mm_per_step.y()),
                               float(step[2] * mm_per_step.z()));
      };
      grid->velocity_mm_s.push_back(nominal(velocity));
      grid->acceleration_mm_s2.push_back(nominal(acceleration));
    }
  }
  return grid;
}

}  // namespace hapticast::server
