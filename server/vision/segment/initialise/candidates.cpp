// SPDX-License-Identifier: MIT
#include "server/vision/segment/initialise/candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "server/vision/base/masks.hpp"
#include "server/vision/base/statistics.hpp"
#include "server/vision/segment/appearance/graph_cut.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/rules.hpp"

namespace hapticast::server {

namespace {

constexpr double kHidden_mm = 90.0;   // chosen: width of a hand
constexpr float kBehind_mm = 20.0F;   // chosen
constexpr double kLeastPiece = 0.02;  // chosen, of the main piece
constexpr double kMostPiece = 2.0;    // likewise
constexpr int kSmallestHole = 80;     // chosen: fills holes smaller than this part of the view

std::vector<cv::Point> traceRim(const cv::Mat& piece) {
  cv::Mat inner;
  cv::erode(piece, inner, cv::Mat::ones(3, 3, CV_8UC1));
  std::vector<cv::Point> out;
  cv::findNonZero(piece & ~inner, out);
  return out;
}

// Returns whether an occluder may hide the joint of piece and mask: they are near each other, and
// no pixel between them lies behind both.
bool isConnectedBehind(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& piece,
                       double px_per_mm) {
  cv::Point from;
  cv::Point to;
  int nearest = 1 << 30;
  const std::vector<cv::Point> rim = traceRim(mask);
  for (const cv::Point& b : traceRim(piece)) {
    for (const cv::Point& a : rim) {
      const int square = (a - b).dot(a - b);
      if (square >= nearest) continue;
      nearest = square;
      from = a;
      to = b;
    }
  }
  if (std::sqrt(nearest) > kHidden_mm * px_per_mm) return false;
  const float deepest = std::max(view.depth.at<float>(from), view.depth.at<float>(to)) + kBehind_mm;
  const int steps = std::max(2, int(std::sqrt(nearest)));
  for (int i = 1; i < steps; ++i) {
    const cv::Point at = from + (to - from) * (double(i) / steps);
    if (view.plane.at<unsigned char>(at) != 0 || view.depth.at<float>(at) > deepest) return false;
  }
  return true;
}

}  // namespace

cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm) {
  const auto [labels, areas_px] = findPieces(mask & ~main);
  cv::Mat out = main.clone();
  if (!usesRule(Rule::kOccludedParts)) return out;
  std::vector<cv::Mat> left;
  left.reserve(areas_px.size());
  for (std::size_t i = 1; i < areas_px.size(); ++i) {
    const double share = double(areas_px[i]) / cv::countNonZero(main);
    if (share < kLeastPiece || share > kMostPiece) continue;
    const cv::Mat piece = labels == double(i);
    if (clearOfBorder(piece)) left.push_back(piece);
  }
  for (bool grows = true; grows;) {
    const std::size_t before = left.size();
    std::erase_if(left, [&](const cv::Mat& piece) {
      if (!isConnectedBehind(view, out, piece, px_per_mm)) return false;
      out |= piece;
      return true;
    });
    grows = left.size() < before;
  }
  return fillHolesOf(out, out.rows * out.cols / kSmallestHole);
}

namespace {

// Tuned on drawn scenes of objects in hands.
constexpr double kReach_mm = 300.0;  // of the view around the click: larger than objects in hands
constexpr double kSame = 0.97;       // IoU
constexpr int kNotRadius_px = 5;
// Chosen: skin farther from the click than this probably is the hand's ...
constexpr float kHandFrom_mm = 50.0F;
constexpr int kHandPixels = 40;    // ... if there is this much of it
constexpr double kNearHand = 0.5;  // share of that skin that may still be the object's
constexpr int kClicked_px = 2;
constexpr float kClicked_mm = 15.0F;
constexpr double kRatherHand = 2.0;  // nats, of the hand's density against the object's
constexpr double kLikeHand = -9.0;   // log density: within three standard deviations

struct Reach {
  float near_mm, far_mm;
};
constexpr std::array kReaches{Reach{15, 60},  Reach{15, 100}, Reach{15, 160}, Reach{30, 100},
                              Reach{30, 160}, Reach{30, 250}, Reach{60, 160}, Reach{60, 250}};

// Data of the click that all cuts share.
struct Surroundings {
  GraphRoi view;
  cv::Point at;
  cv::Mat component;  // 255
  cv::Mat distance;   // CV_32FC1, mm from the click in space
  cv::Mat unary;      // CV_32FC1: evidence without colours
  cv::Mat not_log;    // CV_32FC1: log density of the negative colours; empty: none
  cv::Mat never;      // 255: discs of negative points
  cv::Mat hand;       // 255: the hand that holds the object; none if the colours do not show one
  double px_per_mm = 1.0;
};

double sampleDepth(const cv::Mat& depth, const cv::Point& at) {
  for (const int radius : {2, 12, 40}) {
    const cv::Rect around = cv::Rect(at.x - radius, at.y - radius, 2 * radius + 1, 2 * radius + 1) &
                            cv::Rect({0, 0}, depth.size());
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(around.area()));
    for (int v = around.y; v < around.br().y; ++v) {
      for (int u = around.x; u < around.br().x; ++u) {
        if (depth.at<float>(v, u) > 0) values.push_back(double(depth.at<float>(v, u)));
      }
    }
    if (!values.empty()) return computeMedian(values);
  }
  return 0.0;
}

// Returns the distances in space from the click. Pixels without depth have the click's depth.
cv::Mat distances(const Surroundings& s, double depth_mm, const cv::Size& picture) {
  cv::Mat out(s.view.size(), CV_32FC1);
  const double mm_per_px_at_1mm = 1.0 / (pixelsPerMm(1.0, picture) * s.view.shrink);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      const auto z = double(s.view.depth.at<float>(v, u));
      const double scale = mm_per_px_at_1mm * (z > 0 ? z : depth_mm);
      const double off = z > 0 ? z - depth_mm : 0.0;
      out.at<float>(v, u) =
          static_cast<float>(std::hypot(scale * (u - s.at.x), scale * (v - s.at.y), off));
    }
  }
  return out;
}

// Returns the share of the component among the first measured pixels to the left, right, above and
// below.
float findDepthBeside(const Surroundings& s, int u, int v) {
  int of_it = 0;
  int met = 0;
  for (const cv::Point& way :
       {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
    cv::Point at(u, v);
    do {
      at += way;
      if (!cv::Rect({0, 0}, s.view.size()).contains(at)) break;
    } while (!(s.view.depth.at<float>(at) > 0));
    if (!cv::Rect({0, 0}, s.view.size()).contains(at)) continue;
    ++met;
    if (s.component.at<unsigned char>(at) != 0) ++of_it;
  }
  return met == 0 ? kCutOfCandidate.beside_object
                  : static_cast<float>(of_it) / static_cast<float>(met);
}

// Returns the evidence of depth, planes and skin.
cv::Mat placeEvidence(const Surroundings& s) {
  cv::Mat out = cv::Mat::zeros(s.view.size(), CV_32FC1);
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      float& sum = out.at<float>(v, u);
      const bool of_it = s.component.at<unsigned char>(v, u) != 0;
      if (!(s.view.depth.at<float>(v, u) > 0)) {
        if (usesRule(Rule::kHole))
          sum += kCutOfCandidate.hole * (findDepthBeside(s, u, v) - kCutOfCandidate.beside_object);
      } else if (s.view.plane.at<unsigned char>(v, u) != 0) {
        sum += kCutOfCandidate.plane;
      } else {
        sum += of_it ? kCutOfCandidate.own_depth : kCutOfCandidate.other_depth;
      }
      if (s.hand.at<unsigned char>(v, u) != 0) sum += kCutOfCandidate.skin;
    }
  }
  return out;
}

// The hand's colours are learnt from this hand: from those pixels of skin that are farthest from
// the click (Bayes' rule with two Gaussian mixtures, as in Jones and Rehg 2002). So an object with
// colours of skin differs from the hand that holds it. Dark skin counts where there is no other.
cv::Mat findHand(const FrameContext& scene, const Surroundings& s) {
  const cv::Mat far_off = s.component & (s.distance > kHandFrom_mm);
  cv::Mat skin = s.view.skin & far_off;
  if (cv::countNonZero(skin) < kHandPixels)
    skin = scene.findDarkSkin(s.view.box, s.view.size()) & far_off;
  std::vector<float> far;
  for (int v = 0; v < skin.rows; ++v) {
    for (int u = 0; u < skin.cols; ++u) {
      if (skin.at<unsigned char>(v, u) != 0) far.push_back(s.distance.at<float>(v, u));
    }
  }
  cv::Mat none = cv::Mat::zeros(s.view.size(), CV_8UC1);
  if (!usesRule(Rule::kHandMixture)) return none;
  if (std::ssize(far) < kHandPixels) return none;
  skin &= s.distance > computeQuantile(far, kNearHand);
  cv::Mat clicked = none.clone();
  cv::circle(clicked, s.at, kClicked_px, cv::Scalar(255), cv::FILLED);
  const ColorMixture of_hand(s.view.lab, skin);
  const ColorMixture of_object(s.view.lab, clicked | (s.component & (s.distance < kClicked_mm)));
  if (of_hand.empty() || of_object.empty()) return none;
  const cv::Mat hand = logDensities(of_hand, s.view.lab);
  cv::Mat out =
      (hand - logDensities(of_object, s.view.lab) > kRatherHand) & (hand > kLikeHand) & s.component;
  cv::medianBlur(out, out, 3);
  return out;
}

ColorMixture fitMixture(const NegativeColors& avoided) {
  if (avoided.samples.empty()) return {};
  return {avoided.samples, cv::Mat(avoided.samples.size(), CV_8UC1, cv::Scalar(255))};
}

Surroundings prepareSurroundings(const FrameContext& scene, const Click& click) {
  Surroundings out;
  const cv::Size picture = scene.images.color.size();
  const double depth_mm = std::max(sampleDepth(scene.images.depth, click.at), 1.0);
  const int reach = std::max(50, int(kReach_mm * pixelsPerMm(depth_mm, picture)));
  const cv::Rect box = cv::Rect(click.at.x - reach, click.at.y - reach, 2 * reach, 2 * reach) &
                       cv::Rect({0, 0}, picture);
  out.view = GraphRoi::makeWithValleys(scene, box, kCutOfCandidate.most_px);
  out.at = out.view.toRoi(click.at);
  out.component =
      click.component.empty() ? cv::Mat(out.view.depth > 0) : out.view.shrinkImage(click.component);
  out.distance = distances(out, depth_mm, picture);
  out.px_per_mm = out.view.shrink * pixelsPerMm(depth_mm, picture);
  out.hand = findHand(scene, out);
  out.unary = placeEvidence(out);
  out.never = cv::Mat::zeros(out.view.size(), CV_8UC1);
  const int radius = std::max(1, int(std::lround(kNotRadius_px * out.view.shrink)));
  for (const cv::Point& point : click.not_points) {
    if (box.contains(point))
      cv::circle(out.never, out.view.toRoi(point), radius, cv::Scalar(255), cv::FILLED);
  }
  const ColorMixture not_mixture = fitMixture(click.avoided);
  if (!not_mixture.empty()) out.not_log = logDensities(not_mixture, out.view.lab);
  return out;
}

// Returns the piece with the click, and the pieces connected to it behind an occluder.
cv::Mat selectPieces(const Surroundings& s, const cv::Mat& mask) {
  if (mask.at<unsigned char>(s.at) == 0) return {};
  return mergeOccludedParts(s.view, mask, findPiece(mask, s.at), s.px_per_mm);
}

cv::Mat cutOnce(const Surroundings& s, const cv::Mat& object, const cv::Mat& background,
                const cv::Mat& far, const DepthNoise& noise) {
  const ColorMixture of_object(s.view.lab, object);
  const ColorMixture of_background(s.view.lab, background);
  if (of_object.empty() || of_background.empty()) return {};
  cv::Mat against = logDensities(of_background, s.view.lab);
  if (!s.not_log.empty()) against = cv::max(against, s.not_log);
  cv::Mat color = logDensities(of_object, s.view.lab) - against;
  color = cv::min(cv::max(color, -kCutOfCandidate.most_color), kCutOfCandidate.most_color);
  cv::Mat clicked = cv::Mat::zeros(s.view.size(), CV_8UC1);
  cv::circle(clicked, s.at, 2, cv::Scalar(255), cv::FILLED);
  const CutTerms terms{color + s.unary, clicked, far | s.never};
  return selectPieces(s, minimumCut(terms, s.view, noise, kCutOfCandidate));
}

cv::Mat cutInReach(const Surroundings& s, const Reach& reach, const DepthNoise& noise) {
  const cv::Mat far = s.distance > reach.far_mm;
  const cv::Mat measured = s.view.depth > 0;
  cv::Mat object = s.component & (s.distance < reach.near_mm) & ~(s.never | s.hand);
  cv::circle(object, s.at, 2, cv::Scalar(255), cv::FILLED);
  cv::Mat background = far | s.never | s.view.plane | (measured & (s.component == 0)) | s.hand;
  background.setTo(0, object);
  cv::Mat mask;
  for (int round = 0; round < kCutOfCandidate.rounds; ++round) {
    cv::Mat next = cutOnce(s, object, background, far, noise);
    if (next.empty()) return {};
    const bool settled =
        !mask.empty() && cv::countNonZero(next != mask) < 0.01 * cv::countNonZero(next);
    mask = next;
    if (settled) break;
    object = mask;
    background = mask == 0;
  }
  return mask;
}

bool isNew(const std::vector<cv::Mat>& masks, const cv::Mat& mask) {
  return std::none_of(masks.begin(), masks.end(), [&](const cv::Mat& other) {
    return cv::countNonZero(mask & other) > kSame * cv::countNonZero(mask | other);
  });
}

}  // namespace

Candidates computeCandidates(const FrameContext& scene, const Click& click) {
  Surroundings s = prepareSurroundings(scene, click);
  const cv::Size picture = scene.images.color.size();
  Candidates out;
  std::vector<cv::Mat> small;
  const auto cutAll = [&] {
    for (const Reach& reach : kReaches) {
      cv::Mat mask = cutInReach(s, reach, scene.noise);
      if (!mask.empty() && isNew(small, mask)) small.push_back(mask);
    }
  };
  cutAll();
  if (cv::countNonZero(s.hand) > 0) {  // the colours may be the object's after all
    out.hand = s.view.placeInPicture(s.hand, picture);
    s.hand.setTo(0);
    s.unary = placeEvidence(s);
    cutAll();
  }
  if (!s.not_log.empty()) {  // so may those of the negative points
    s.not_log.release();
    cutAll();
  }
  out.masks.reserve(small.size());
  for (const cv::Mat& mask : small) out.masks.push_back(s.view.placeInPicture(mask, picture));
  return out;
}

}  // namespace hapticast::server
