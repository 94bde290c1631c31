// SPDX-License-Identifier: MIT
#include "server/source/scale/depth_scale.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace hapticast::server {

namespace {

// Chosen: the smallest depth step that is an edge, as a share of the nearer depth. Surfaces have
// less between neighbouring pixels, and sensors have less noise.
constexpr float kStep = 0.02F;
constexpr float kStep_levels = 8.0F;  // likewise for 8-bit depth
// Measured on drawn scenes (server/source/README.md): deviation of places that belong to one side
// of an edge, px of the depth; weight of the places against the colours; noise of colours, levels.
constexpr double kPlaceSigma_px = 1.0;
constexpr float kPlaceWeight = 4.0F;
constexpr float kColorNoise = 8.0F;
constexpr int kReach_px = 2;  // the neighbourhood that decides, px of the depth
constexpr int kWide = 2 * kReach_px + 1;

using Weights = std::array<float, kWide>;

/// One axis of a picture that is enlarged.
struct EnlargedAxis {
  std::vector<int> begin;      // first pixel of each pixel of the depth, and the end
  std::vector<Weights> share;  // weights of the neighbours of each pixel, by place

  EnlargedAxis(int from, int to) : begin(static_cast<std::size_t>(from) + 1, to) {
    share.resize(static_cast<std::size_t>(to));
    for (int at = to - 1; at >= 0; --at) {
      const double place = (at + 0.5) * from / to;
      const int nearest = std::min(static_cast<int>(place), from - 1);
      begin[static_cast<std::size_t>(nearest)] = at;
      Weights& weights = share[static_cast<std::size_t>(at)];
      float sum = 0.0F;
      for (int k = 0; k < kWide; ++k) {
        const double away_px = (nearest + k - kReach_px + 0.5 - place) / kPlaceSigma_px;
        sum += weights[static_cast<std::size_t>(k)] =
            static_cast<float>(std::exp(-0.5 * away_px * away_px));
      }
      for (float& weight : weights) weight /= sum;
    }
  }
  /// Returns the first pixel of the pixel `at` of the depth, and the first one of the next.
  [[nodiscard]] std::pair<int, int> findPixels(int at) const {
    const auto index = static_cast<std::size_t>(at);
    return {begin[index], begin[index + 1]};
  }
};

/// A colour as plain numbers: this is the innermost loop.
struct EdgeColor {
  float b = 0.0F, g = 0.0F, r = 0.0F;

  [[nodiscard]] float squaredDistance(const EdgeColor& other) const {
    const float db = b - other.b;
    const float dg = g - other.g;
    const float dr = r - other.r;
    return db * db + dg * dg + dr * dr;
  }
};

/// One side of an edge in the neighbourhood of a pixel of the depth.
struct EdgeSide {
  float count = 0.0F;
  EdgeColor mean;        // the sum until finish()
  float squares = 0.0F;  // sum of the squared colours

  void add(const EdgeColor& color) {
    ++count;
    mean.b += color.b;
    mean.g += color.g;
    mean.r += color.r;
    squares += color.squaredDistance({});
  }
  /// Sets the mean. Returns the sum of the squared deviations from it.
  float finish() {
    mean = {mean.b / count, mean.g / count, mean.r / count};
    return squares - count * mean.squaredDistance({});
  }
};

/// Decides the pixels near the edges of one picture.
class EdgeDecider {
 public:
  EdgeDecider(const cv::Mat& depth, DepthKind kind, const cv::Mat& color)
      : depth_(depth),
        color_(color),
        metric_(kind == DepthKind::kMetric),
        factor_(metric_ ? 1.0F + kStep : 1.0F),
        step_(metric_ ? 0.0F : kStep_levels),
        across_(depth.cols, color.cols),
        down_(depth.rows, color.rows),
        colors_(depth.size(), CV_32FC3),
        has_color_(cv::Mat::zeros(depth.size(), CV_8UC1)),
        decided_(cv::Mat::zeros(depth.size(), CV_8UC1)) {}

  void decide(cv::Mat& scaled) {
    cv::Mat farthest;
    cv::dilate(depth_, farthest, cv::Mat());
    for (int v = 0; v < depth_.rows; ++v) {
      const auto* const high = farthest.ptr<float>(v);
      const auto* const here = depth_.ptr<float>(v);
      for (int u = 0; u < depth_.cols; ++u) {
        if (high[u] > findLimit(here[u]) && isMeasured(here[u])) decideEdge({u, v}, scaled);
      }
    }
  }

 private:
  [[nodiscard]] bool isMeasured(float depth) const { return !metric_ || depth > 0.0F; }

  /// Returns the largest depth of the same surface beside a depth.
  [[nodiscard]] float findLimit(float depth) const { return factor_ * depth + step_; }

  /// Decides `cell`, on the nearer side of an edge, and its neighbours on the other side.
  void decideEdge(const cv::Point& cell, cv::Mat& scaled) {
    const float limit = findLimit(depth_.at<float>(cell));
    for (int v = std::max(cell.y - 1, 0); v <= std::min(cell.y + 1, depth_.rows - 1); ++v) {
      for (int u = std::max(cell.x - 1, 0); u <= std::min(cell.x + 1, depth_.cols - 1); ++u) {
        const cv::Point at(u, v);
        if (at != cell && depth_.at<float>(at) <= limit) continue;
        auto& decided = decided_.at<unsigned char>(at);
        if (decided == 0) decideCell(at, scaled);
        decided = 1;
      }
    }
  }

  /// Returns the mean colour of a pixel of the depth.
  EdgeColor findColor(int u, int v) {
    auto& mean = colors_.at<cv::Vec3f>(v, u);
    auto& has_color = has_color_.at<unsigned char>(v, u);
    if (has_color != 0) return {mean[0], mean[1], mean[2]};
    has_color = 1;
    const auto [x_begin, x_end] = across_.findPixels(u);
    const auto [y_begin, y_end] = down_.findPixels(v);
    cv::Vec3i sum;
    for (int y = y_begin; y < y_end; ++y) {
      const auto* const row = color_.ptr<cv::Vec3b>(y);
      for (int x = x_begin; x < x_end; ++x) {
        for (int c = 0; c < 3; ++c) sum[c] += row[x][c];
      }
    }
    const float share = 1.0F / static_cast<float>((y_end - y_begin) * (x_end - x_begin));
    mean = {share * static_cast<float>(sum[0]), share * static_cast<float>(sum[1]),
            share * static_cast<float>(sum[2])};
    return {mean[0], mean[1], mean[2]};
  }

  /// Copies the neighbourhood of `cell`. A pixel that is outside or not measured becomes -1.
  void copyNeighbours(const cv::Point& cell) {
    float low = std::numeric_limits<float>::max();
    float high = 0.0F;
    std::size_t k = 0;
    for (int v = cell.y - kReach_px; v <= cell.y + kReach_px; ++v) {
      const auto* const row = v >= 0 && v < depth_.rows ? depth_.ptr<float>(v) : nullptr;
      for (int u = cell.x - kReach_px; u <= cell.x + kReach_px; ++u, ++k) {
        around_[k] = -1.0F;
        if (row == nullptr || u < 0 || u >= depth_.cols || !isMeasured(row[u])) continue;
        around_[k] = row[u];
        low = std::min(low, row[u]);
        high = std::max(high, row[u]);
      }
    }
    middle_ = 0.5F * (low + high);
  }

  /// Parts the neighbours of `cell` in the middle of their range.
  void part(const cv::Point& cell) {
    sides_ = {};
    std::size_t k = 0;
    for (int v = cell.y - kReach_px; v <= cell.y + kReach_px; ++v) {
      for (int u = cell.x - kReach_px; u <= cell.x + kReach_px; ++u, ++k) {
        const bool nearer = around_[k] < middle_;
        leans_[k] = around_[k] < 0.0F ? 0.0F : (nearer ? 1.0F : -1.0F);
        if (leans_[k] != 0.0F) sides_[nearer ? 1 : 0].add(findColor(u, v));
      }
    }
    const float spread = sides_[0].finish() + sides_[1].finish();
    const float variance =
        spread / (3.0F * (sides_[0].count + sides_[1].count)) + kColorNoise * kColorNoise;
    color_weight_ = 0.5F / variance;
  }

  void decideCell(const cv::Point& cell, cv::Mat& scaled) {
    copyNeighbours(cell);
    part(cell);
    const bool own = depth_.at<float>(cell) < middle_;
    const auto [x_begin, x_end] = across_.findPixels(cell.x);
    const auto [y_begin, y_end] = down_.findPixels(cell.y);
    for (int y = y_begin; y < y_end; ++y) {
      const Weights& down = down_.share[static_cast<std::size_t>(y)];
      Weights columns{};  // how much each column leans to the nearer side
      for (std::size_t row = 0; row < kWide; ++row) {
        for (std::size_t k = 0; k < kWide; ++k) columns[k] += down[row] * leans_[row * kWide + k];
      }
      const auto* const color = color_.ptr<cv::Vec3b>(y);
      auto* const out = scaled.ptr<float>(y);
      for (int x = x_begin; x < x_end; ++x) {
        const Weights& across = across_.share[static_cast<std::size_t>(x)];
        float lean = 0.0F;
        for (std::size_t k = 0; k < kWide; ++k) lean += across[k] * columns[k];
        const EdgeColor here{float(color[x][0]), float(color[x][1]), float(color[x][2])};
        const float likeness =
            here.squaredDistance(sides_[0].mean) - here.squaredDistance(sides_[1].mean);
        const bool nearer = kPlaceWeight * lean + color_weight_ * likeness > 0.0F;
        if (nearer != own) out[x] = findNearest(nearer, across, down);
      }
    }
  }

  /// Returns the depth of the pixel of one side that is nearest in place.
  [[nodiscard]] float findNearest(bool nearer, const Weights& across, const Weights& down) const {
    float most = -1.0F;
    float depth = 0.0F;
    for (std::size_t row = 0; row < kWide; ++row) {
      for (std::size_t column = 0; column < kWide; ++column) {
        const std::size_t k = row * kWide + column;
        const float weight = down[row] * across[column];
        if (leans_[k] != (nearer ? 1.0F : -1.0F) || weight <= most) continue;
        most = weight;
        depth = around_[k];
      }
    }
    return depth;
  }

  const cv::Mat& depth_;
  const cv::Mat& color_;
  bool metric_;
  float factor_;  // farther than this factor of the nearer depth, plus `step_`, is an edge
  float step_;
  EnlargedAxis across_;
  EnlargedAxis down_;
  cv::Mat colors_;  // mean colours of the pixels of the depth, where `has_color_` is not 0
  cv::Mat has_color_;
  cv::Mat decided_;  // not 0: the pixel of the depth was decided
  // Of the pixel of the depth that is decided:
  std::array<float, std::size_t{kWide} * kWide> around_{};  // neighbouring depths, below 0: none
  std::array<float, std::size_t{kWide} * kWide> leans_{};   // 1: nearer, -1: farther, 0: none
  std::array<EdgeSide, 2> sides_{};                         // farther, nearer
  float middle_ = 0.0F;                                     // between the sides
  float color_weight_ = 0.0F;
};

}  // namespace

bool isSameAspect(cv::Size a, cv::Size b) {
  if (a.empty() || b.empty()) return false;
  const double first = static_cast<double>(a.width) * b.height;
  const double second = static_cast<double>(b.width) * a.height;
  constexpr double kTolerance = 0.01;  // sizes of video are rounded to even numbers
  return std::abs(first - second) <= kTolerance * std::max(first, second);
}

std::string aspectRemedy(cv::Size depth, cv::Size color) {
  const bool turned = isSameAspect({depth.height, depth.width}, color);
  return turned && !isSameAspect(depth, color)
             ? "; turn it by 90 degrees (ffmpeg -i FILE -vf transpose=1 OUT)"
             : "; scale one to the other's size";
}

cv::Mat scaleDepth(const cv::Mat& depth, DepthKind kind, const cv::Mat& color) {
  if (depth.size() == color.size()) return depth;
  cv::Mat scaled;
  cv::resize(depth, scaled, color.size(), 0.0, 0.0, cv::INTER_NEAREST_EXACT);
  if (depth.cols < color.cols && depth.rows < color.rows)
    EdgeDecider(depth, kind, color).decide(scaled);
  return scaled;
}

void logScaledDepth(const std::string& place, cv::Size from, cv::Size to) {
  spdlog::info("{}: depth of {} x {} is scaled to {} x {}", place, from.width, from.height,
               to.width, to.height);
}

}  // namespace hapticast::server
