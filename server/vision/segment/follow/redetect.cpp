// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/redetect.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/appearance/graph_cut.hpp"
#include "server/vision/segment/initialise/candidates.hpp"

namespace hapticast::server {

namespace {

constexpr double kWhole_px = 20000.0;  // chosen for time: largest size of a view of the picture
constexpr double kMargin = 0.4;        // chosen, of the object's width: reach of the search
// Weights of the score, tuned on drawn scenes of objects in hands.
constexpr double kForColors = 1.5;
constexpr double kForArea = 0.5;

// Returns the colours' evidence, averaged after its lookup: averaged colours would blur patterns.
cv::Mat collectColors(const FrameContext& scene, const GraphRoi& view,
                      const ContourMemory& memory) {
  const cv::Mat full = mapEvidence(scene.images.color(view.box), computeColorEvidence(memory));
  cv::Mat out;
  cv::resize(full, out, view.size(), 0, 0, cv::INTER_AREA);
  return kCutOfRedetection.color * out;
}

cv::Mat computeEvidence(const FrameContext& scene, const GraphRoi& view, const KnownObject& known) {
  cv::Mat out = collectColors(scene, view, known.memory);
  cv::Mat beyond = (view.depth > 0) & (view.depth < known.limits.nearest_mm);
  if (known.limits.farthest_mm > 0) beyond |= view.depth > known.limits.farthest_mm;
  const auto add = [&out](float evidence, const cv::Mat& where) {
    cv::add(out, cv::Scalar(double(evidence)), out, where);
  };
  add(kCutOfRedetection.other_depth, beyond);
  add(kCutOfRedetection.plane, view.plane & ~beyond);
  add(kCutOfRedetection.skin, view.skin & findHand(view.color, known.limits));
  if (known.mask.empty()) return out;
  const cv::Mat mask = view.shrinkImage(known.mask);
  cv::Mat inner;
  cv::Mat outer;
  cv::distanceTransform(mask, inner, cv::DIST_L2, 3);
  cv::distanceTransform(mask == 0, outer, cv::DIST_L2, 3);
  const cv::Mat distance = cv::min(cv::max(inner - outer, -kCutOfRedetection.farthest_px),
                                   kCutOfRedetection.farthest_px);
  return out + kCutOfRedetection.per_px * distance;
}

// Returns the piece that shares most pixels with the expected mask, else the largest piece.
cv::Mat findMainPiece(const cv::Mat& cut, const cv::Mat& expected) {
  const auto [labels, areas_px] = findPieces(cut);
  cv::Mat best;
  int most = 0;
  for (std::size_t i = 1; i < areas_px.size(); ++i) {
    if (areas_px[i] <= most) continue;
    const cv::Mat piece = labels == double(i);
    const int here = expected.empty() ? areas_px[i] : cv::countNonZero(piece & expected);
    if (here <= most) continue;
    most = here;
    best = piece;
  }
  return best;
}

}  // namespace

cv::Mat redetect(const FrameContext& scene, const KnownObject& known) {
  const cv::Size picture = scene.images.color.size();
  cv::Rect box({0, 0}, picture);
  if (!known.mask.empty()) {
    const cv::Rect tight = findBoxAround(known.mask, 0);
    box = findBoxAround(known.mask, 10 + int(kMargin * std::max(tight.width, tight.height)));
  }
  if (!known.window.empty()) box = known.window;
  if (box.area() < 100) return {};
  const bool whole = known.mask.empty() && known.window.empty();
  const double most_px = whole ? kWhole_px : kCutOfRedetection.most_px;
  const GraphRoi view = GraphRoi::makeAround(scene, box, most_px);
  const cv::Mat cut =
      minimumCut({computeEvidence(scene, view, known)}, view, scene.noise, kCutOfRedetection);
  const cv::Mat expected = known.mask.empty() ? cv::Mat() : view.shrinkImage(known.mask);
  const cv::Mat main = findMainPiece(cut, expected);
  if (main.empty()) return {};
  const double depth_mm = 0.5 * (known.limits.nearest_mm + known.limits.farthest_mm);
  const double px_per_mm = view.shrink * pixelsPerMm(depth_mm, picture);
  return view.placeInPicture(mergeOccludedParts(view, cut, main, px_per_mm), picture);
}

double reidentificationScore(const FrameContext& scene, const KnownObject& known,
                             const cv::Mat& mask) {
  const double area = std::max(1, cv::countNonZero(mask));
  const double like =
      computeOverlap(ColorHistogram::fromImage(scene.images.color, mask), known.memory.first);
  const double size = std::log(area / std::max(known.usual_px, 1.0));
  return objectness(scene, mask) + kForColors * like - kForArea * size * size;
}

}  // namespace hapticast::server
