// SPDX-License-Identifier: MIT
#include "server/vision/segment/choose.hpp"

#include <algorithm>

#include "server/vision/segment/candidates.hpp"
#include "server/vision/segment/segment.hpp"
#include "server/vision/segment/start.hpp"

namespace hapticast::server {

namespace {

constexpr int kSettledCuts = 3;         // chosen for time: so many of the best cuts are settled ...
constexpr int kFewRounds = 3;           // ... by so many band steps
constexpr double kForComponent = -0.1;  // what depth alone says has hands in it
constexpr double kForSettled = 0.03;
constexpr double kDespiteDepth = 2.5;  // where depth says that there is nothing

struct Candidate {
  BandObject object;
  double likeness;
};

}  // namespace

ChosenStart chooseAt(const FrameImages& images, const BandScene& scene, const cv::Point& point,
                     const std::vector<cv::Point>& not_points) {
  ObjectStart start = objectAt(images.depth, point, scene.noise, scene.planes);
  BandScene own = scene;
  if (start.why_not == nullptr) own.planes = start.planes;
  const SceneView view = own.view(images);
  std::vector<Candidate> candidates;
  const auto take = [&](const BandObject& object, double more) {
    if (cv::countNonZero(object.mask()) < kSmallestObject_px) return;
    candidates.push_back({object, likenessToThing(view, object.mask()) + more});
  };
  if (start.why_not == nullptr) {
    const cv::Mat cut = cutByColor(images, start.mask, own.planes, point, not_points);
    take(BandObject(0, cut, images, own), kForComponent);
  }
  std::vector<cv::Mat> cuts = cutsAround(view, {point, not_points, start.mask});
  std::vector<std::pair<double, cv::Mat>> scored;
  scored.reserve(cuts.size());
  for (const cv::Mat& cut : cuts) scored.emplace_back(likenessToThing(view, cut), cut);
  std::sort(scored.begin(), scored.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  if (scored.size() > kSettledCuts) scored.resize(kSettledCuts);
  for (const auto& [likeness, cut] : scored) {
    take(BandObject(0, cut, images, own, kFewRounds), kForSettled);
    take(BandObject(0, cut, images, own, 0), 0.0);
  }
  const auto best = std::max_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.likeness < b.likeness; });
  if (best == candidates.end() || (start.why_not != nullptr && best->likeness < kDespiteDepth)) {
    const char* why = start.why_not != nullptr ? start.why_not : "there is next to nothing";
    return {std::nullopt, why, {}};
  }
  return {std::move(best->object), nullptr, std::move(own.planes)};
}

}  // namespace hapticast::server
