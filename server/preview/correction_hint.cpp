// SPDX-License-Identifier: MIT
#include "server/preview/correction_hint.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/initialise/candidates.hpp"
#include "server/vision/segment/initialise/initial_mask.hpp"
#include "server/vision/segment/initialise/refine_clicks.hpp"

namespace hapticast::server {

namespace {

// Chosen, of the object's area: a smaller part is not worth a hint, a larger part is the object.
constexpr double kLeastPart = 0.06;
constexpr double kMostPart = 0.6;
// Chosen, as part of the width: pixels nearer to the picture's edge count as touching it.
constexpr double kEdge = 0.02;
// Chosen, CIELAB: a distance of clearly different colours.
constexpr double kOtherColor = 40.0;
// Chosen: precision needed for a point.
constexpr int kLargestClustered_px = 20'000;

// Chosen, as part of the picture's width: a hint so near to a click would contradict it. The region
// of a hint counts as larger by the second number.
constexpr double kNearClick = 0.06;
constexpr int kRim_px = 4;
// Chosen: a smaller gain of the score is noise.
constexpr double kClearGain = 0.1;

// Part of a mask that may not belong to the object.
struct Suspect {
  cv::Point at_px;
  cv::Mat region;
  const char* why;
};

// Returns whether the author said that the object is there.
bool contradicts(const Suspect& suspect, const std::vector<cv::Point>& clicks) {
  const cv::Mat region = dilateBy(suspect.region, kRim_px);
  const double near_px = kNearClick * region.cols;
  return std::any_of(clicks.begin(), clicks.end(), [&](const cv::Point& click) {
    if (cv::norm(click - suspect.at_px) < near_px) return true;
    return cv::Rect({0, 0}, region.size()).contains(click) && region.at<unsigned char>(click) != 0;
  });
}

// Returns the largest piece of `part` with its deepest place, if its size is worth a hint.
std::optional<Suspect> findLargestPart(const cv::Mat& part, double object_px, const char* why) {
  cv::Mat opened;
  cv::morphologyEx(part, opened, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  const Pieces pieces = findPieces(opened);
  const int largest = pieces.largest();
  const int area_px = pieces.areas_px[static_cast<std::size_t>(largest)];
  if (area_px < kLeastPart * object_px || area_px > kMostPart * object_px) return std::nullopt;
  const cv::Mat region = pieces.labels == largest;
  return Suspect{findDeepestPoint(region), region, why};
}

std::optional<Suspect> findSuspectAtEdge(const cv::Mat& mask) {
  const int rim_px = std::max(2, static_cast<int>(kEdge * mask.cols));
  if (std::min(mask.cols, mask.rows) <= 2 * rim_px) return std::nullopt;
  cv::Mat inner = cv::Mat::zeros(mask.size(), CV_8UC1);
  inner(cv::Rect(rim_px, rim_px, mask.cols - 2 * rim_px, mask.rows - 2 * rim_px)).setTo(255);
  const cv::Mat rim = mask & ~inner;
  const int edge_px = cv::countNonZero(rim) / rim_px;
  if (edge_px < rim_px) return std::nullopt;
  const cv::Rect deeper(2 * rim_px, 2 * rim_px, mask.cols - 4 * rim_px, mask.rows - 4 * rim_px);
  if (deeper.empty()) return std::nullopt;
  cv::Mat near = mask.clone();
  near(deeper).setTo(0);
  const cv::Point at = findDeepestPoint(near);
  const cv::Mat labels = findPieces(near).labels;
  return Suspect{at, labels == labels.at<int>(at),
                 "it reaches the picture's edge there, as an arm does"};
}

std::optional<Suspect> skin(const FrameContext& scene, const cv::Mat& mask) {
  return findLargestPart(scene.skin.findSkin(scene.images.color) & mask, cv::countNonZero(mask),
                         "it has the colours of skin there, as a hand does");
}

std::optional<Suspect> anotherColor(const cv::Mat& color, const cv::Mat& mask) {
  cv::Mat smooth;
  cv::GaussianBlur(color, smooth, {}, 3.0);
  smooth.convertTo(smooth, CV_32F, 1.0 / 255.0);
  cv::Mat lab;
  cv::cvtColor(smooth, lab, cv::COLOR_BGR2Lab);
  std::vector<cv::Point> inside;
  cv::findNonZero(mask, inside);
  const auto step = std::max(std::size_t{1}, inside.size() / kLargestClustered_px);
  std::vector<cv::Vec3f> samples;
  samples.reserve(inside.size() / step + 1);
  for (std::size_t i = 0; i < inside.size(); i += step)
    samples.push_back(lab.at<cv::Vec3f>(inside[i]));
  if (samples.size() < 16) return std::nullopt;
  cv::Mat labels;
  cv::Mat middles;
  cv::theRNG().state = 1;  // the same hint for the same picture
  const cv::Mat rows(static_cast<int>(samples.size()), 3, CV_32F, samples.data());
  cv::kmeans(rows, 2, labels, {cv::TermCriteria::COUNT, 20, 0}, 2, cv::KMEANS_PP_CENTERS, middles);
  if (cv::norm(middles.row(0), middles.row(1)) < kOtherColor) return std::nullopt;
  const auto second = cv::countNonZero(labels);
  const int fewer = 2 * second < static_cast<int>(samples.size()) ? 1 : 0;
  const cv::Vec3f own = middles.at<cv::Vec3f>(1 - fewer);
  const cv::Vec3f other = middles.at<cv::Vec3f>(fewer);
  cv::Mat part = cv::Mat::zeros(mask.size(), CV_8UC1);
  for (const cv::Point& at : inside) {
    const cv::Vec3f& here = lab.at<cv::Vec3f>(at);
    if (cv::norm(here, other) < cv::norm(here, own)) part.at<unsigned char>(at) = 255;
  }
  return findLargestPart(part, static_cast<double>(inside.size()),
                         "it has other colours there than elsewhere");
}

// Adds the largest part of the mask that each of the candidates at `at` leaves out.
void addExcludedParts(const FrameContext& scene, const cv::Mat& mask, const cv::Point& at,
                      std::vector<Suspect>& out) {
  const ObjectStart start = findObject(scene.images.depth, at, scene.noise, scene.planes);
  const Candidates candidates = computeCandidates(scene, {at, {}, {}, start.mask});
  for (const cv::Mat& candidate : candidates.masks) {
    if (auto part = findLargestPart(mask & ~candidate, cv::countNonZero(mask),
                                    "the outline is clearer without it"))
      out.push_back(std::move(*part));
  }
}

// `on_it`: those of the clicks that are in the mask.
std::vector<Suspect> listSuspects(const FrameContext& scene, const cv::Mat& mask,
                                  const std::vector<cv::Point>& clicks,
                                  const std::vector<cv::Point>& on_it) {
  std::vector<Suspect> out;
  for (auto suspect :
       {findSuspectAtEdge(mask), skin(scene, mask), anotherColor(scene.images.color, mask)}) {
    if (suspect) out.push_back(std::move(*suspect));
  }
  addExcludedParts(scene, mask, on_it.empty() ? findDeepestPoint(mask) : on_it.front(), out);
  std::erase_if(out, [&](const Suspect& suspect) { return contradicts(suspect, clicks); });
  return out;
}

}  // namespace

std::optional<CorrectionHint> suggestCorrection(const FrameImages& images, const cv::Mat& mask,
                                                const std::vector<cv::Point>& clicks) {
  if (cv::countNonZero(mask) == 0) return std::nullopt;
  const DepthNoise noise = measureNoise(images.depth);
  cv::Mat background = images.depth.clone();
  background.setTo(0, mask);
  std::vector<Plane> planes = findPlanes(background, noise);
  findSupports(images.depth, mask, planes);
  const SkinColors skin_colors = SkinColors::adaptToLight(images.color);
  const FrameContext scene{images, planes, noise, skin_colors};
  // A click on another object says nothing about this one.
  std::vector<cv::Point> on_it = clicks;
  std::erase_if(on_it, [&](const cv::Point& click) { return !contains(mask, click); });
  std::optional<CorrectionHint> best;
  double highest = objectness(scene, mask) + kClearGain;
  for (const Suspect& suspect : listSuspects(scene, mask, clicks, on_it)) {
    const cv::Mat corrected = refineWithClicks(scene, mask, {{}, {suspect.at_px}, {}}, on_it);
    const double score = objectness(scene, corrected);
    if (score <= highest) continue;
    highest = score;
    best = CorrectionHint{suspect.at_px, suspect.why};
  }
  return best;
}

}  // namespace hapticast::server
