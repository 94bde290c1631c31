// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_trials.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/masks.hpp"
#include "tests/scenes/held/draw.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kGoodStart = 0.8;  // IoU
constexpr double kBadStart = 0.5;
constexpr double kFromEdge_px = 3.0;   // authors click farther from the edge
constexpr double kWorthAPoint = 0.02;  // of the object's area: authors leave smaller faults
constexpr double kWide_px = 2.0;       // nor what is thinner than this to each side
constexpr double kShownEnough = 1.0 / 3.0;
constexpr std::size_t kAfter = 5;  // frames in which a correction may not empty the object
constexpr double kEmpty = 0.1;     // of the true area
constexpr int kNear_px = 40;       // a hand beside the object

// The hands' pixels, but not at the object's very edge.
cv::Mat handsIn(const Truth& truth) {
  const cv::Mat hands =
      (truth.id == static_cast<int>(kHand)) | (truth.id == static_cast<int>(kOtherHand));
  return hands & ~server::dilateBy(truth.mask(), 3);
}

cv::Mat handsBeside(const Truth& truth, int reach_px) {
  return handsIn(truth) & server::dilateBy(truth.mask(), reach_px);
}

// Adds a correction for `frame`. Returns whether it says something new.
bool say(const Recording& recording, const Run& run, std::size_t frame, Words& words) {
  const double time_s = recording.frames[frame].clip_time_s;
  const auto wrong = findLargestWrong(recording, run, frame);
  if (wrong && wrong->share > kWorthAPoint && wrong->depth_px > kWide_px) {
    (wrong->foreign ? words.off : words.on).push_back({wrong->middle_px, time_s});
    return true;
  }
  if (const auto hand = innermost(handsBeside(recording.truth[frame], kNear_px)))
    words.off.push_back({*hand, time_s});
  return false;
}

double shareKept(const Recording& recording, const Run& run, std::size_t frame) {
  if (run.masks[frame].empty()) return 0.0;
  const cv::Mat own = recording.truth[frame].mask();
  return cv::countNonZero(run.masks[frame] & own) / std::max(1.0, double(cv::countNonZero(own)));
}

bool emptied(const Recording& recording, const Run& before, const Run& after, std::size_t frame) {
  const std::size_t end = std::min(frame + kAfter + 1, after.masks.size());
  for (std::size_t i = frame; i < end; ++i) {
    if (recording.truth[i].visibleShare() > kShownEnough &&
        shareKept(recording, before, i) >= kEmpty && shareKept(recording, after, i) < kEmpty)
      return true;
  }
  return false;
}

Vec2 turnedPoint(const Vec2& at, const cv::Size& size, int code) {
  if (code == cv::ROTATE_90_CLOCKWISE) return {size.height - at.y(), at.x()};
  if (code == cv::ROTATE_180) return {size.width - at.x(), size.height - at.y()};
  return {at.y(), size.width - at.x()};
}

server::SourceInfo turnedInfo(const server::SourceInfo& info, int code) {
  server::SourceInfo out = info;
  const cv::Size size(info.width_px, info.height_px);
  if (code != cv::ROTATE_180) std::swap(out.width_px, out.height_px);
  if (!info.camera) return out;
  const server::CameraModel& camera = *info.camera;
  const Vec2 centre = turnedPoint({camera.cx_px, camera.cy_px}, size, code);
  const bool upright = code == cv::ROTATE_180;
  out.camera = {upright ? camera.fx_px : camera.fy_px, upright ? camera.fy_px : camera.fx_px,
                centre.x(), centre.y()};
  return out;
}

// The mask that a click begins with on the picture turned by `code`, turned back.
cv::Mat startTurned(const Recording& recording, const Vec2& click, int code) {
  const server::RgbdFrame& upright = recording.frames.front();
  server::RgbdFrame frame = upright;
  frame.color = cv::Mat();
  frame.depth = cv::Mat();
  cv::rotate(upright.color, frame.color, code);
  cv::rotate(upright.depth, frame.depth, code);
  const Vec2 at = turnedPoint(click, upright.color.size(), code);
  const auto mask = startOf(frame, turnedInfo(recording.info, code), {{{at}}, {}, {}});
  cv::Mat out = cv::Mat::zeros(upright.color.size(), CV_8UC1);
  const int back = code == cv::ROTATE_90_CLOCKWISE          ? cv::ROTATE_90_COUNTERCLOCKWISE
                   : code == cv::ROTATE_90_COUNTERCLOCKWISE ? cv::ROTATE_90_CLOCKWISE
                                                            : cv::ROTATE_180;
  if (mask) cv::rotate(*mask, out, back);
  return out;
}

double leastOverlapTurned(const Recording& recording, const Vec2& click) {
  const auto start = startOf(recording.frames.front(), recording.info, {{{click}}, {}, {}});
  double least = 1.0;
  for (const int code : {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE}) {
    const cv::Mat turned = startTurned(recording, click, code);
    // Refused in both is the same answer.
    if (!start && cv::countNonZero(turned) == 0) continue;
    least = std::min(least, start ? server::computeOverlap(*start, turned) : 0.0);
  }
  return least;
}

}  // namespace

Starts clickAround(const Recording& recording, std::size_t frame, double clicks) {
  const cv::Mat truth = recording.truth[frame].mask();
  cv::Mat distance;
  cv::distanceTransform(truth, distance, cv::DIST_L2, 5);
  const int step = std::max(2, static_cast<int>(std::sqrt(cv::countNonZero(truth) / clicks)));
  Starts out;
  for (int v = step / 2; v < truth.rows; v += step) {
    for (int u = step / 2; u < truth.cols; u += step) {
      if (double(distance.at<float>(v, u)) < kFromEdge_px) continue;
      ++out.clicks;
      const auto mask =
          startOf(recording.frames[frame], recording.info, {{{{u + 0.5, v + 0.5}}}, {}, {}});
      if (!mask) ++out.refused;
      const double iou = mask ? server::computeOverlap(*mask, truth) : 0.0;
      if (iou > kGoodStart) ++out.good;
      if (iou < kBadStart) ++out.bad;
    }
  }
  return out;
}

std::optional<WrongPiece> findLargestWrong(const Recording& recording, const Run& run,
                                           std::size_t frame) {
  const cv::Mat truth = recording.truth[frame].mask();
  const double area = std::max(1, cv::countNonZero(truth));
  const cv::Mat mask =
      run.masks[frame].empty() ? cv::Mat::zeros(truth.size(), CV_8UC1) : run.masks[frame];
  std::optional<WrongPiece> out;
  for (const bool foreign : {true, false}) {
    const cv::Mat wrong = foreign ? mask & ~truth : truth & ~mask;
    const server::Pieces pieces = server::findPieces(wrong);
    const int label = pieces.largest();
    if (label == 0) continue;
    const double share = pieces.areas_px[static_cast<std::size_t>(label)] / area;
    if (out && share <= out->share) continue;
    const cv::Mat piece = pieces.labels == label;
    cv::Mat distance;
    cv::distanceTransform(piece, distance, cv::DIST_L2, 5);
    double deepest = 0.0;
    cv::minMaxLoc(distance, nullptr, &deepest);
    out = {share, *innermost(piece), deepest, foreign};
  }
  return out;
}

Corrected correctAtRandomTimes(const Recording& recording, const Run& run, const Words& words) {
  Corrected out;
  Draw draw(recording.sensing.seed + 77);
  Words said = words;
  Run now = run;
  for (int n = 0; n < 2; ++n) {
    const std::size_t frame = 1 + draw.oneOf(recording.frames.size() - 1);
    if (!say(recording, now, frame, said)) ++out.uninformative;
    Run next = runVision(recording, said);
    if (emptied(recording, now, next, frame)) ++out.emptied;
    now = std::move(next);
  }
  out.scores = scoresOf(recording, now);
  return out;
}

TurnedScores compareTurned(const Recording& recording) {
  TurnedScores out;
  const Truth& truth = recording.truth.front();
  out.on_object = leastOverlapTurned(recording, *innermost(truth.mask()));
  if (const auto hand = innermost(handsIn(truth)))
    out.on_hand = leastOverlapTurned(recording, *hand);
  return out;
}

Trials tryOut(const Recording& recording, const Run& run, const Words& click, double clicks) {
  Trials out;
  for (std::size_t i = 0; i < out.starts.size(); ++i) {
    const std::size_t frame = i * recording.frames.size() / out.starts.size();
    const bool at_hand = cv::countNonZero(handsBeside(recording.truth[frame], 8)) > 0;
    if (!at_hand || recording.truth[frame].visibleShare() <= kShownEnough) continue;
    out.starts[i] = clickAround(recording, frame, clicks);
    const auto chosen = startOf(recording.frames[frame], recording.info, {});
    out.chosen_iou[i] =
        chosen ? server::computeOverlap(*chosen, recording.truth[frame].mask()) : 0.0;
  }
  out.corrected = correctAtRandomTimes(recording, run, click);
  out.cut = compareWithGrabCut(recording, run);
  out.turned = compareTurned(recording);
  return out;
}

}  // namespace hapticast::evaluate::held
