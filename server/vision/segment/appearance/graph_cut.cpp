// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/graph_cut.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

#include "server/vision/segment/rules.hpp"

namespace hapticast::server {

namespace {

constexpr int kParts = 5;                  // as in GrabCut
constexpr std::size_t kMostSamples = 800;  // chosen for time
constexpr float kLeastSpread = 16;         // squared, Lab: effect of a camera's noise and shading

// Returns colours in an order that does not depend on how the picture is turned.
cv::Mat collectSamples(const cv::Mat& lab, const cv::Mat& where) {
  std::vector<std::array<float, 3>> colors;
  colors.reserve(lab.total());
  for (int v = 0; v < lab.rows; ++v) {
    for (int u = 0; u < lab.cols; ++u) {
      const auto& at = lab.at<cv::Vec3f>(v, u);
      if (where.at<unsigned char>(v, u) != 0) colors.push_back({at[0], at[1], at[2]});
    }
  }
  std::sort(colors.begin(), colors.end());
  const std::size_t stride = std::max<std::size_t>(1, colors.size() / kMostSamples);
  cv::Mat out(static_cast<int>((colors.size() + stride - 1) / stride), 3, CV_32F);
  for (int i = 0; i < out.rows; ++i)
    std::copy_n(colors[static_cast<std::size_t>(i) * stride].begin(), 3, out.ptr<float>(i));
  return out;
}

}  // namespace

ColorMixture::ColorMixture(const cv::Mat& lab, const cv::Mat& where) {
  const cv::Mat samples = collectSamples(lab, where);
  if (samples.rows < 8) return;
  const int parts = std::min(kParts, samples.rows / 4);
  cv::Mat labels;
  cv::setRNGSeed(7);
  cv::kmeans(samples, parts, labels,
             cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 8, 0.5), 1,
             cv::KMEANS_PP_CENTERS);
  for (int part = 0; part < parts; ++part) {
    cv::Vec3f sum(0, 0, 0);
    cv::Matx33f squares = cv::Matx33f::zeros();
    int count = 0;
    for (int i = 0; i < samples.rows; ++i) {
      if (labels.at<int>(i) != part) continue;
      const cv::Vec3f at(samples.ptr<float>(i));
      sum += at;
      squares += at * at.t();
      ++count;
    }
    if (count == 0) continue;
    const cv::Vec3f mean = sum / static_cast<float>(count);
    const cv::Matx33f covariance = squares * (1.0F / static_cast<float>(count)) - mean * mean.t() +
                                   cv::Matx33f::eye() * kLeastSpread;
    const auto determinant = static_cast<float>(cv::determinant(covariance));
    const float weight = static_cast<float>(count) / static_cast<float>(samples.rows);
    parts_.push_back({mean, covariance.inv(), std::log(weight) - 0.5F * std::log(determinant)});
  }
}

float ColorMixture::logDensity(const cv::Vec3f& lab) const {
  float most = kLeast;
  float sum = 0.0F;
  std::array<float, kParts> logs{};
  std::size_t count = 0;
  for (const Part& part : parts_) {
    const cv::Vec3f off = lab - part.mean;
    logs[count] = part.log_weight - 0.5F * off.dot(part.inverse * off);
    most = std::max(most, logs[count++]);
  }
  for (std::size_t i = 0; i < count; ++i) sum += std::exp(logs[i] - most);
  return std::max(kLeast, most + std::log(std::max(sum, 1e-6F)));
}

cv::Mat logDensities(const ColorMixture& mixture, const cv::Mat& lab) {
  cv::Mat out(lab.size(), CV_32FC1);
  for (int v = 0; v < lab.rows; ++v) {
    for (int u = 0; u < lab.cols; ++u)
      out.at<float>(v, u) = mixture.logDensity(lab.at<cv::Vec3f>(v, u));
  }
  return out;
}

namespace {

struct Offset {
  int u, v;
};
constexpr std::array kNeighbours{Offset{1, 0}, Offset{0, 1}, Offset{1, 1}, Offset{-1, 1}};

/// Calls `take`(a, b, square of the difference in Lab) for all pairs of neighbours.
template <class Take>
void forEachNeighbour(const cv::Mat& lab, Take take) {
  for (int v = 0; v < lab.rows; ++v) {
    for (int u = 0; u < lab.cols; ++u) {
      for (const Offset& way : kNeighbours) {
        const cv::Point to(u + way.u, v + way.v);
        if (to.x < 0 || to.x >= lab.cols || to.y >= lab.rows) continue;
        const cv::Vec3f off = lab.at<cv::Vec3f>(v, u) - lab.at<cv::Vec3f>(to);
        take(cv::Point(u, v), to, off.dot(off));
      }
    }
  }
}

cv::Mat sumTerms(const CutTerms& terms, float sure) {
  cv::Mat out = terms.evidence.clone();
  if (!terms.background.empty()) out.setTo(-sure, terms.background);
  if (!terms.object.empty()) out.setTo(sure, terms.object);
  return out;
}

}  // namespace

cv::Mat minimumCut(const CutTerms& terms, const GraphRoi& view, const DepthNoise& noise,
                   const CutWeights& weights) {
  const cv::Mat unary = sumTerms(terms, weights.sure);
  const int nodes = unary.rows * unary.cols;
  cv::detail::GCGraph<float> graph(static_cast<unsigned>(nodes), static_cast<unsigned>(8 * nodes));
  for (int v = 0; v < unary.rows; ++v) {
    for (int u = 0; u < unary.cols; ++u) {
      const int node = graph.addVtx();
      const float value = unary.at<float>(v, u);
      graph.addTermWeights(node, std::max(value, 0.0F), std::max(-value, 0.0F));
    }
  }
  double squares = 0.0;
  double count = 0.0;
  forEachNeighbour(view.lab, [&](const cv::Point&, const cv::Point&, float square) {
    squares += double(square);
    count += 1.0;
  });
  const auto beta = static_cast<float>(0.5 * count / std::max(squares, 1e-3));
  forEachNeighbour(view.lab, [&](const cv::Point& a, const cv::Point& b, float square) {
    const float from = view.depth.at<float>(a);
    const float to = view.depth.at<float>(b);
    const bool step = from > 0 && to > 0 && std::abs(from - to) > view.step_mm(noise, from);
    const float apart = a.x != b.x && a.y != b.y ? 0.7071F : 1.0F;
    const float valley = view.valley.empty() || !usesRule(Rule::kValley)
                             ? 0.0F
                             : std::max(view.valley.at<float>(a), view.valley.at<float>(b));
    const float across =
        step ? weights.across_step : 1.0F - (1.0F - weights.across_valley) * valley;
    const float cost = weights.together * apart * std::exp(-beta * square) * across;
    graph.addEdges(a.y * unary.cols + a.x, b.y * unary.cols + b.x, cost, cost);
  });
  graph.maxFlow();
  cv::Mat out(unary.size(), CV_8UC1);
  for (int i = 0; i < nodes; ++i)
    out.at<unsigned char>(i / unary.cols, i % unary.cols) = graph.inSourceSegment(i) ? 255 : 0;
  return out;
}

}  // namespace hapticast::server
