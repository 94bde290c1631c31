// SPDX-License-Identifier: MIT
#include "server/vision/segment/follow/select_initial_mask.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/candidates.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/initialise/object_proposals.hpp"
#include "server/vision/segment/rules.hpp"
#include "server/vision/segment/segmenter.hpp"

namespace hapticast::server {

namespace {

constexpr int kSettledCuts = 3;         // chosen for time: number of best cuts to refine ...
constexpr int kFewRounds = 3;           // ... and their number of band steps
constexpr double kForComponent = -0.1;  // chosen: the depth component often includes a hand
// Chosen: a cut is coarser than a settled one, unless settling loses more of the score than this.
constexpr double kForSettled = 0.1;
// Chosen: most chosen masks of drawn scenes with an IoU above 0.8 score higher.
constexpr double kSurelyObject = 1.0;
// Measured: where depth shows a table or nothing, clicks on objects score higher, and few clicks on
// a background do.
constexpr double kDespiteDepth = 1.2;

// Chosen: objects in hands are narrower than the first width, in space. A wider part of an object
// wider than the second width belongs to a body: then the whole is meant.
constexpr double kHeld_mm = 200.0;
constexpr double kBody_mm = 260.0;
constexpr double kPart_mm = 150.0;  // chosen: so does a part of this width with the body's colours
constexpr double kAlike = 0.2;      // chosen, ObjectnessTerms::apart: the colours of such a part

constexpr double kHand_mm = 60.0;  // chosen: a hand, or its fingers alone, is wider
constexpr double kMostlySkin = 0.5;
constexpr double kDistinctBelow = 0.9;  // chosen, IoU: authors see no difference above it

struct Candidate {
  TrackedMask object;
  ObjectnessTerms terms;
  double score;
  const char* origin;
};

bool isBody(const Candidate& part, const Candidate& whole) {
  const double least_mm = part.terms.apart < kAlike ? kPart_mm : kHeld_mm;
  return part.terms.width_mm > least_mm && whole.terms.width_mm > kBody_mm;
}

// Returns the patch of skin at the click, within the click's component of depth.
cv::Mat findSkinAt(const FrameContext& scene, const cv::Mat& component, const cv::Point& at) {
  const cv::Rect box = findBoxAround(component, 0);
  cv::Mat patch = cv::Mat::zeros(component.size(), CV_8UC1);
  if (!box.contains(at)) return patch;
  const cv::Mat skin = scene.skin.findSkin(scene.images.color(box)) & component(box);
  if (skin.at<unsigned char>(at - box.tl()) != 0) findPiece(skin, at - box.tl()).copyTo(patch(box));
  return patch;
}

// A point on a hand means the hand with its arm. The skin of an arm continues to the picture's
// border or to a sleeve, which belongs to the same component. An object with colours of skin is a
// candidate of its own, clear of the arm.
bool isHand(const FrameContext& scene, const cv::Mat& component, const cv::Point& at,
            const Candidate& best) {
  if (best.terms.skin < kMostlySkin || best.score > kSurelyObject) return false;
  const cv::Mat patch = findSkinAt(scene, component, at);
  if (cv::countNonZero(patch) == 0 || widthInSpace_mm(scene, patch) < kHand_mm) return false;
  return !clearOfBorder(component) ||
         cv::countNonZero(component) > 2 * cv::countNonZero(best.object.mask());
}

// Computes the candidates at one point and their scores.
class Selection {
 public:
  // `hand`: Candidates::hand.
  Selection(const FrameImages& images, const SceneContext& scene, const cv::Mat& hand)
      : images_(images), scene_(scene), view_(scene.view(images)) {
    view_.hand = hand;
  }

  void add(TrackedMask object, double more, const char* origin) {
    if (cv::countNonZero(object.mask()) < kSmallestObject_px) return;
    const ObjectnessTerms terms = computeObjectnessTerms(view_, object.mask());
    candidates_.push_back({std::move(object), terms, objectness(terms) + more, origin});
  }
  // Adds the best of the cuts. Steps of the narrow band settle a cut, unless it gets worse.
  void addCuts(const std::vector<cv::Mat>& cuts) {
    std::vector<std::pair<double, cv::Mat>> scored;
    scored.reserve(cuts.size());
    for (const cv::Mat& cut : cuts) scored.emplace_back(objectness(view_, cut), cut);
    std::stable_sort(scored.begin(), scored.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    if (scored.size() > kSettledCuts) scored.resize(kSettledCuts);
    // Cuts are coarser in a large picture.
    const int larger = std::max(images_.color.cols, images_.color.rows) / kUsualWidth_px;
    for (const auto& [score, cut] : scored) {
      const TrackedMask settled(0, cut, images_, scene_, kFewRounds * std::max(1, larger));
      const double after = objectness(view_, settled.mask());
      if (usesRule(Rule::kSettledCut) && after + kForSettled >= score) {
        add(settled, std::max(0.0, score - after), "settled cut");
      } else {
        add(TrackedMask(0, cut, images_, scene_, 0), 0.0, "cut");
      }
    }
  }
  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  /// Returns the candidate with the highest score; null if there is none.
  [[nodiscard]] const Candidate* best() const {
    const auto best =
        std::max_element(candidates_.begin(), candidates_.end(),
                         [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    return best == candidates_.end() ? nullptr : &*best;
  }

 private:
  const FrameImages& images_;
  const SceneContext& scene_;
  FrameContext view_;
  std::vector<Candidate> candidates_;
};

// Returns the chosen candidate, then the others by falling score, without those that look alike.
std::vector<TrackedMask> rankDistinct(const std::vector<Candidate>& candidates,
                                      const Candidate& chosen) {
  std::vector<const Candidate*> order{&chosen};
  for (const Candidate& each : candidates) {
    if (&each != &chosen) order.push_back(&each);
  }
  std::stable_sort(order.begin() + 1, order.end(),
                   [](const auto* a, const auto* b) { return a->score > b->score; });
  std::vector<TrackedMask> out;
  for (const Candidate* each : order) {
    const bool is_new = std::none_of(out.begin(), out.end(), [&](const TrackedMask& other) {
      return computeOverlap(other.mask(), each->object.mask()) >= kDistinctBelow;
    });
    if (is_new) out.push_back(each->object);
  }
  return out;
}

}  // namespace

ChosenStart selectInitialMask(const FrameImages& images, const SceneContext& scene,
                              const cv::Point& point, const std::vector<cv::Point>& not_points) {
  ObjectStart start = findObject(images.depth, point, scene.noise, scene.planes);
  SceneContext own = scene;
  const bool has_component = start.why_not == nullptr;
  own.planes = start.planes;
  const FrameContext view = own.view(images);
  const Candidates cuts = computeCandidates(view, {point, not_points, scene.avoided, start.mask});
  Selection selection(images, own, cuts.hand);
  if (has_component && usesRule(Rule::kComponent)) {
    const cv::Mat cut = cutByColor(images, start.mask, own.planes, point, not_points);
    selection.add(TrackedMask(0, cut, images, own), kForComponent, "component of depth");
  }
  selection.addCuts(cuts.masks);
  const Candidate* best = selection.best();
  if (best == nullptr)
    return {std::nullopt, has_component ? "there are too few pixels" : start.why_not, 0.0};
  if (!has_component && !start.too_small && best->score < kDespiteDepth)
    return {std::nullopt, start.why_not, 0.0};
  const Candidate& whole = selection.candidates().front();
  const bool has_whole = has_component && usesRule(Rule::kComponent);
  const bool hand =
      usesRule(Rule::kHandIsWhole) && has_whole && isHand(view, start.mask, point, *best);
  const bool body = usesRule(Rule::kBodyIsWhole) && has_whole && isBody(*best, whole);
  if (hand || body) best = &whole;
  ChosenStart out{best->object, nullptr, objectness(best->terms), std::move(own.planes),
                  rankDistinct(selection.candidates(), *best)};
  if (!cuts.hand.empty()) {
    const auto learn = [&](TrackedMask& object) {  // the object's rim has mixed colours
      object.learnHand(images.color, cuts.hand & ~dilateBy(object.mask(), kBand_px));
    };
    learn(*out.object);
    std::for_each(out.ranked.begin(), out.ranked.end(), learn);
  }
  for (const Candidate& each : selection.candidates())
    out.explanation.push_back(fmt::format("at {},{}: {}{} {:.2f}, {}", point.x, point.y,
                                          &each == best ? "chosen: " : "", each.origin, each.score,
                                          toText(each.terms)));
  return out;
}

namespace {

// Weights of the automatic choice, tuned on drawn scenes of objects in hands and on tables.
constexpr double kForFarther = 0.5;    // of ln(depth over that of the nearest proposal)
constexpr double kForOffCentre = 2.0;  // of the distance from the middle, in half diagonals
constexpr double kForHeld = 0.3;       // of an object at the end of a limb
// Chosen: of ln(share of the picture); on drawn scenes 0 to 0.3 are equally good, in an office a
// chair's corner of 0.1 % won without it.
constexpr double kForSmall = 0.3;
constexpr double kUsualShare = 0.03;

double rateProposal(const ObjectProposal& proposal, double nearest_mm, const cv::Mat& mask) {
  const cv::Point2d middle(0.5 * mask.cols, 0.5 * mask.rows);
  const double off =
      cv::norm(computeCentroid(cv::moments(mask, true), {0, 0}) - middle) / cv::norm(middle);
  const double share = cv::countNonZero(mask) / double(mask.total());
  return (proposal.at_limb ? kForHeld : 0.0) - kForOffCentre * off -
         kForSmall * std::max(0.0, std::log(kUsualShare / share)) -
         kForFarther * std::log(proposal.depth_mm / nearest_mm);
}

}  // namespace

ChosenStart selectAutomatically(const FrameImages& images, const SceneContext& scene,
                                const std::vector<cv::Point>& not_points) {
  const cv::Rect whole({0, 0}, images.depth.size());
  const cv::Mat labels =
      depthComponents(images.depth, findOnPlanes(images.depth, whole, scene.planes), scene.noise);
  ChosenStart best{std::nullopt, "there is no object that stands out"};
  double highest = 0.0;
  cv::Mat seen = cv::Mat::zeros(images.depth.size(), CV_8UC1);
  std::vector<std::string> explanation;
  const std::vector<ObjectProposal> proposals = proposeObjects(scene.view(images), labels);
  for (const ObjectProposal& proposal : proposals) {
    if (contains(seen, proposal.at)) continue;
    ChosenStart next = selectInitialMask(images, scene, proposal.at, not_points);
    if (!next.object) {
      explanation.push_back(
          fmt::format("proposal at {},{}: {}", proposal.at.x, proposal.at.y, next.why_not));
      continue;
    }
    seen |= next.object->mask();
    const double rate = rateProposal(proposal, proposals.front().depth_mm, next.object->mask());
    explanation.push_back(fmt::format("proposal at {},{}: score {:.2f}, place {:.2f}",
                                      proposal.at.x, proposal.at.y, next.score, rate));
    const bool is_held = next.score >= kSurelyObject &&
                         widthInSpace_mm(scene.view(images), next.object->mask()) < kHeld_mm;
    if (proposal.at_limb && !is_held) continue;  // a limb that holds nothing, or a lap
    if (best.object && next.score + rate <= highest) continue;
    highest = next.score + rate;
    best = std::move(next);
  }
  best.explanation.insert(best.explanation.begin(), explanation.begin(), explanation.end());
  return best;
}

}  // namespace hapticast::server
