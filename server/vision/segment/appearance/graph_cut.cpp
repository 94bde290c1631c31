// SPDX-License-Identifier: MIT
#include "server/vision/segment/appearance/graph_cut.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace hapticast::server {

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
    const float valley =
        view.valley.empty() ? 0.0F : std::max(view.valley.at<float>(a), view.valley.at<float>(b));
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
