// SPDX-License-Identifier: MIT
#include "server/vision/motion/cell_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/haptic_frame.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

// Chosen, of what is fitted about a cell's centre: half a cell's neighbour still counts fully, and
// the slope over it is believed from a few points on.
constexpr double kReach_px = 28.0;
constexpr double kWide_px = 13.0;  // sigma of the weights
constexpr double kSlopePrior = 0.15;
constexpr double kCellTukey = 4.6;  // standard deviations (Huber, Robust Statistics)
constexpr double kCellFloor =
    0.05;  // px or mm, chosen: what agrees as well as that is not told apart
constexpr int kCellRounds = 3;
constexpr std::size_t kFewestSteps = 4;  // tracks about a cell

// A plane through the steps about a place, by their distances and Tukey's weights; its value there.
double planeAt(const std::vector<std::array<double, 3>>& offs_weights,
               const std::vector<double>& values) {
  std::vector<double> sorted = values;
  Eigen::Vector3d plane(medianOf(sorted), 0.0, 0.0);
  for (int round = 0; round < kCellRounds; ++round) {
    std::vector<double> misses;
    misses.reserve(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& [x, y, unused] = offs_weights[i];
      misses.push_back(std::abs(values[i] - plane.dot(Eigen::Vector3d(1.0, x, y))));
    }
    sorted = misses;
    const double limit = kCellTukey * std::max(kCellFloor, sigmaByMedian(sorted));
    Eigen::Matrix3d matrix = Eigen::Vector3d(0.0, kSlopePrior, kSlopePrior).asDiagonal();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& [x, y, weight] = offs_weights[i];
      const double share = std::max(0.0, 1.0 - misses[i] * misses[i] / (limit * limit));
      const Eigen::Vector3d row(1.0, x, y);
      matrix += weight * share * share * row * row.transpose();
      right += weight * share * share * values[i] * row;
    }
    const Eigen::Vector3d next = matrix.ldlt().solve(right);
    if (!next.allFinite()) break;
    plane = next;
  }
  return plane[0];
}

// Of the tracks about the middle of a cell; nullopt: there are too few.
std::optional<cv::Vec3f> fittedAt(const std::vector<LeftStep>& left, const cv::Point2f& middle) {
  std::vector<std::array<double, 3>> offs_weights;
  std::array<std::vector<double>, 3> values;
  for (const LeftStep& track : left) {
    const cv::Point2f off = track.at_px - middle;
    const double square = double(off.dot(off));
    if (square > kReach_px * kReach_px) continue;
    offs_weights.push_back({double(off.x) / kGridCell_px, double(off.y) / kGridCell_px,
                            std::exp(-0.5 * square / (kWide_px * kWide_px))});
    for (std::size_t axis = 0; axis < 3; ++axis) values[axis].push_back(track.step[axis]);
  }
  if (offs_weights.size() < kFewestSteps) return std::nullopt;
  cv::Vec3f out;
  for (std::size_t axis = 0; axis < 3; ++axis)
    out[static_cast<int>(axis)] = static_cast<float>(planeAt(offs_weights, values[axis]));
  return out;
}

// What is beyond the object goes on as the cells beside it, for a viewer reads between the cells;
// where nothing is known it is 0.
void spread(cv::Mat& cells, cv::Mat& known) {
  for (int left = std::max(cells.rows, cells.cols); left > 0; --left) {
    cv::Mat sum;
    cv::Mat weight;
    cv::Mat weights;
    known.convertTo(weights, CV_32F, 1.0 / 255.0);
    cv::boxFilter(cells, sum, -1, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
    cv::boxFilter(weights, weight, -1, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
    const cv::Mat fresh = (weight > 0.5F) & (known == 0);
    if (cv::countNonZero(fresh) == 0) return;
    for (int v = 0; v < cells.rows; ++v) {
      for (int u = 0; u < cells.cols; ++u) {
        if (fresh.at<unsigned char>(v, u) != 0)
          cells.at<cv::Vec3f>(v, u) = sum.at<cv::Vec3f>(v, u) / weight.at<float>(v, u);
      }
    }
    known.setTo(255, fresh);
  }
}

}  // namespace

cv::Mat cellsFittedTo(const std::vector<LeftStep>& left, int columns, int rows) {
  cv::Mat out = cv::Mat::zeros(rows, columns, CV_32FC3);
  cv::Mat known = cv::Mat::zeros(rows, columns, CV_8UC1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto half = 0.5F * (kGridCell_px - 1);  // places are pixel centres at whole numbers
      const cv::Point2f middle(float(column * kGridCell_px) + half,
                               float(row * kGridCell_px) + half);
      const auto fitted = fittedAt(left, middle);
      if (!fitted) continue;
      out.at<cv::Vec3f>(row, column) = *fitted;
      known.at<unsigned char>(row, column) = 255;
    }
  }
  spread(out, known);
  return out;
}

}  // namespace hapticast::server
