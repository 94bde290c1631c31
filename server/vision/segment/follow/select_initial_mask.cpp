// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/select_initial_mask.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/candidates.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr int kSettledCuts = 3;         // chosen for time: number of best cuts to refine ...
constexpr int kFewRounds = 3;           // ... and their number of band steps
constexpr double kForComponent = -0.1;  // the depth component often includes a hand
constexpr double kForSettled = 0.03;
constexpr double kDespiteDepth = 2.5;  // threshold where depth shows no object

// Chosen: objects in hands are narrower than the first width, in space. A wider part of an object
// wider than the second width belongs to a body: then the whole is meant.
constexpr double kHeld_mm = 200.0;
constexpr double kBody_mm = 260.0;

constexpr double kHand_mm = 60.0;  // chosen: a hand, or its fingers alone, is wider

struct Candidate {
  TrackedMask object;
  double likeness;
};

bool isBody(const FrameContext& scene, const TrackedMask& part, const TrackedMask& whole) {
  return widthInSpace_mm(scene, part.mask()) > kHeld_mm &&
         widthInSpace_mm(scene, whole.mask()) > kBody_mm;
}

// A point on a hand means the hand with its arm. A skin-coloured patch of another object is small.
bool isHand(const FrameContext& scene, const cv::Mat& component, const cv::Point& at) {
  const cv::Rect box = boxAround(component, 0);
  if (!box.contains(at)) return false;
  const cv::Mat skin = scene.skin.in(scene.images.color(box)) & component(box);
  if (skin.at<unsigned char>(at - box.tl()) == 0) return false;
  cv::Mat patch = cv::Mat::zeros(component.size(), CV_8UC1);
  pieceAt(skin, at - box.tl()).copyTo(patch(box));
  return widthInSpace_mm(scene, patch) > kHand_mm;
}

}  // namespace

ChosenStart selectInitialMask(const FrameImages& images, const SceneContext& scene,
                              const cv::Point& point, const std::vector<cv::Point>& not_points) {
  ObjectStart start = findObject(images.depth, point, scene.noise, scene.planes);
  SceneContext own = scene;
  if (start.why_not == nullptr) own.planes = start.planes;
  const FrameContext view = own.view(images);
  std::vector<Candidate> candidates;
  const auto take = [&](const TrackedMask& object, double more) {
    if (cv::countNonZero(object.mask()) < kSmallestObject_px) return;
    candidates.push_back({object, objectness(view, object.mask()) + more});
  };
  if (start.why_not == nullptr) {
    const cv::Mat cut = cutByColor(images, start.mask, own.planes, point, not_points);
    take(TrackedMask(0, cut, images, own), kForComponent);
  }
  std::vector<cv::Mat> cuts = candidateMasks(view, {point, not_points, scene.avoided, start.mask});
  std::vector<std::pair<double, cv::Mat>> scored;
  scored.reserve(cuts.size());
  for (const cv::Mat& cut : cuts) scored.emplace_back(objectness(view, cut), cut);
  std::sort(scored.begin(), scored.end(),
            [](const auto& a, const auto& b) { return a.first > b.first; });
  if (scored.size() > kSettledCuts) scored.resize(kSettledCuts);
  // Cuts are coarser in a large picture.
  const int rounds = kFewRounds * std::max(1, images.color.cols / kUsualWidth_px);
  for (const auto& [likeness, cut] : scored) {
    take(TrackedMask(0, cut, images, own, rounds), kForSettled);
    take(TrackedMask(0, cut, images, own, 0), 0.0);
  }
  auto best = std::max_element(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.likeness < b.likeness; });
  if (start.why_not == nullptr && best != candidates.end() &&
      (isHand(view, start.mask, point) || isBody(view, best->object, candidates.front().object)))
    best = candidates.begin();
  if (best == candidates.end() || (start.why_not != nullptr && best->likeness < kDespiteDepth)) {
    const char* why = start.why_not != nullptr ? start.why_not : "there are too few pixels";
    return {std::nullopt, why, {}};
  }
  return {std::move(best->object), nullptr, std::move(own.planes)};
}

}  // namespace hapticast::server
