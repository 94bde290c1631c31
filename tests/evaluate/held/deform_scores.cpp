// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/deform_scores.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "server/vision/base/statistics.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr int kEvery_px = 3;           // pixels that are compared, each way
constexpr double kDeforms_mm_s = 3.0;  // nominal, rms: smaller motion is not measured
constexpr double kTravels_mm_s = 3.0;  // nominal, rms
constexpr std::size_t kBeginning = 4;  // frames: nothing has been seen before them
constexpr std::size_t kFewestPlaces = 30;

// Sent and true motion of the pixels of one frame, 3 rows each; columns of `rigid` are what the six
// ways of a rigid body to move would be there.
struct Field {
  Eigen::VectorXd truth, grid, sent;
  Eigen::MatrixXd rigid;
  bool has_grid = false;

  // What no rigid motion explains.
  [[nodiscard]] Eigen::VectorXd apart(const Eigen::VectorXd& motion) const {
    return motion - rigid * rigid.colPivHouseholderQr().solve(motion);
  }
};

double rms(const Eigen::VectorXd& rows) {
  return rows.size() > 0 ? std::sqrt(3.0 * rows.squaredNorm() / double(rows.size())) : 0.0;
}

double rmsOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / std::max(1.0, double(values.size())));
}

double median(std::vector<double> values) {
  return values.empty() ? -1.0 : server::computeMedian(values);
}

class Judge {
 public:
  Judge(const Recording& recording, const Run& run) : recording_(recording), run_(run) {
    workspace_.width_px = recording.info.width_px;
    workspace_.height_px = recording.info.height_px;
    const server::DepthRange range = run.mapped.value_or(server::DepthRange{0.0, 1.0});
    per_depth_ = -workspace_.depth_mm / (range.far_mm - range.near_mm);
  }

  [[nodiscard]] Field fieldOf(std::size_t frame) const;
  // Sent minus true velocity of the place that is followed, and the true one.
  [[nodiscard]] std::pair<Vec3, Vec3> middleOf(std::size_t frame) const;

 private:
  // The sent velocity in space, nominal.
  [[nodiscard]] Vec3 nominal(const Vec3& at, const Vec3& v) const {
    const Vec2 mm = workspace_.mmPerPixel();
    const double per_mm = recording_.camera.fx_px / (at.z() * at.z());
    return {mm.x() * per_mm * (v.x() * at.z() - at.x() * v.z()),
            -mm.y() * per_mm * (v.y() * at.z() - at.y() * v.z()), per_depth_ * v.z()};
  }
  [[nodiscard]] double time(std::size_t frame) const {
    return recording_.frames[frame].clip_time_s;
  }

  const Recording& recording_;
  const Run& run_;
  Workspace workspace_;
  double per_depth_ = 0.0;
};

// As a viewer reads it: bilinear between the cells' centres.
Vec3 gridAt(const MotionGrid& grid, double x, double y) {
  const auto axis = [](double at_px, int cells) {
    return std::clamp(at_px / kGridCell_px - 0.5, 0.0, double(cells - 1));
  };
  const double u = axis(x, grid.columns);
  const double v = axis(y, grid.rows);
  const int i = std::min(static_cast<int>(u), std::max(0, grid.columns - 2));
  const int j = std::min(static_cast<int>(v), std::max(0, grid.rows - 2));
  const auto cell = [&](int column, int row) -> Vec3 {
    const int at = std::min(row, grid.rows - 1) * grid.columns + std::min(column, grid.columns - 1);
    return grid.velocity_mm_s[static_cast<std::size_t>(at)].cast<double>();
  };
  const double a = u - i;
  const double b = v - j;
  return (1 - b) * ((1 - a) * cell(i, j) + a * cell(i + 1, j)) +
         b * ((1 - a) * cell(i, j + 1) + a * cell(i + 1, j + 1));
}

const HapticObject* objectAt(const std::vector<HapticObject>& objects, int u, int v) {
  for (const HapticObject& object : objects) {
    const PixelRect& rect = object.relief->rect;
    const int x = u - rect.u;
    const int y = v - rect.v;
    if (x < 0 || y < 0 || x >= rect.width || y >= rect.height) continue;
    if (object.relief->mask[std::size_t(y) * std::size_t(rect.width) + std::size_t(x)] != 0)
      return &object;
  }
  return nullptr;
}

Field Judge::fieldOf(std::size_t frame) const {
  const Truth& truth = recording_.truth[frame];
  const cv::Mat own = truth.mask();
  std::vector<Vec3> exact, grid, sent, places;
  Field out;
  for (int v = 0; v < own.rows; v += kEvery_px) {
    for (int u = 0; u < own.cols; u += kEvery_px) {
      if (own.at<uchar>(v, u) == 0) continue;
      const HapticObject* object = objectAt(run_.objects[frame], u, v);
      if (object == nullptr) continue;
      const Vec3 at = double(truth.depth.at<float>(v, u)) * recording_.camera.ray(u + 0.5, v + 0.5);
      places.push_back(at);
      exact.push_back(nominal(at, recording_.object.velocityAt(at, time(frame))));
      const Motion& motion = object->motion;
      const Vec2 off = workspace_.toNominal({u + 0.5, v + 0.5}) - motion.position_mm.head<2>();
      const double turning = motion.angular_velocity_rad_s;
      sent.emplace_back(motion.velocity_mm_s + turning * Vec3(-off.y(), off.x(), 0.0));
      grid.emplace_back(Vec3::Zero());
      if (!object->grid) continue;
      out.has_grid = true;
      grid.back() =
          gridAt(*object->grid, u + 0.5 - object->relief->rect.u, v + 0.5 - object->relief->rect.v);
      sent.back() += grid.back();
    }
  }
  const auto count = std::ssize(places);
  const auto rows = [&](const std::vector<Vec3>& of) {
    Eigen::VectorXd all(3 * count);
    for (std::ptrdiff_t i = 0; i < count; ++i) all.segment<3>(3 * i) = of[std::size_t(i)];
    return all;
  };
  out.truth = rows(exact);
  out.grid = rows(grid);
  out.sent = rows(sent);
  out.rigid.resize(3 * count, 6);
  const Vec3 pivot = truth.centre.pose.at_mm;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Vec3& at = places[std::size_t(i)];
    for (int k = 0; k < 3; ++k) {
      out.rigid.block<3, 1>(3 * i, k) = nominal(at, Vec3::Unit(k));
      out.rigid.block<3, 1>(3 * i, 3 + k) = nominal(at, Vec3::Unit(k).cross(at - pivot) / 100.0);
    }
  }
  return out;
}

std::pair<Vec3, Vec3> Judge::middleOf(std::size_t frame) const {
  const Motion& sent = run_.objects[frame].front().motion;
  const Vec2 px = workspace_.toImage(sent.position_mm.head<2>());
  const double z = run_.mapped->far_mm + sent.position_mm.z() / per_depth_;
  const Vec3 at = z * recording_.camera.ray(px.x(), px.y());
  const Vec3 exact = nominal(at, recording_.object.path.at(time(frame)).velocityAt(at));
  return {sent.velocity_mm_s - exact, exact};
}

// Every third row from `first` on: of the picture's two axes the first two, of depth the third.
Eigen::VectorXd axesOf(const Eigen::VectorXd& rows, int first, int count) {
  Eigen::VectorXd out(rows.size() / 3 * count);
  for (Eigen::Index i = 0; i < rows.size() / 3; ++i)
    out.segment(i * count, count) = rows.segment(3 * i + first, count);
  return out;
}

}  // namespace

DeformScores deformScoresOf(const Recording& recording, const Run& run) {
  DeformScores out;
  if (!run.mapped) return out;
  const Judge judge(recording, run);
  std::vector<double> shares, flats, deeps, grids, aparts, speeds, offs, middles, middle_offs;
  double with = 0.0;
  double counted = 0.0;
  const std::size_t last = run.objects.size() - std::min(run.objects.size(), kBeginning);
  for (std::size_t i = kBeginning; i < last; ++i) {
    if (run.objects[i].empty()) continue;
    const Field field = judge.fieldOf(i);
    if (std::size_t(field.truth.size()) < 3 * kFewestPlaces) continue;
    const Eigen::VectorXd apart = field.apart(field.truth);
    const Eigen::VectorXd left = field.apart(field.truth - field.grid);
    grids.push_back(rms(field.grid));
    speeds.push_back(rms(field.truth));
    const auto [off, middle] = judge.middleOf(i);
    middles.push_back(middle.norm());
    if (speeds.back() > kTravels_mm_s) {
      offs.push_back(rms(field.sent - field.truth));
      middle_offs.push_back(off.norm());
    }
    const bool deforms = rms(apart) > kDeforms_mm_s;
    if (recording.object.deforms() && !deforms) continue;
    with += field.has_grid ? 1.0 : 0.0;
    counted += 1.0;
    if (!deforms) continue;
    aparts.push_back(rms(apart));
    shares.push_back(1.0 - rms(left) / rms(apart));
    flats.push_back(1.0 - rms(axesOf(left, 0, 2)) / rms(axesOf(apart, 0, 2)));
    deeps.push_back(1.0 - rms(axesOf(left, 2, 1)) / rms(axesOf(apart, 2, 1)));
  }
  out.deforms = !shares.empty();
  out.share = median(shares);
  out.flat = median(flats);
  out.deep = median(deeps);
  out.looked = with / std::max(1.0, counted);
  out.grid_mm_s = rmsOf(grids);
  out.apart_mm_s = rmsOf(aparts);
  if (!offs.empty()) {
    out.surface = median(offs) / rmsOf(speeds);
    out.middle = median(middle_offs) / rmsOf(middles);
  }
  out.median_ms = median(run.ms);
  return out;
}

}  // namespace hapticast::evaluate::held
