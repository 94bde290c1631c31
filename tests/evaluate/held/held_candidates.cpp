// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_candidates.hpp"

#include <algorithm>

#include "server/vision/base/masks.hpp"
#include "server/vision/segment/follow/select_initial_mask.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kSeenForChoice = 1.0 / 3.0;  // share of the object that is seen

CandidateScores compareAt(const Recording& recording, std::size_t at) {
  const cv::Mat truth = recording.truth[at].mask();
  const auto click = innermost(truth);
  if (!click || recording.truth[at].visibleShare() < kSeenForChoice) return {};
  server::RgbdFrame frame = recording.frames[at];
  frame.index = 0;
  server::FramePairs pairs(recording.info, false);
  const server::FramePair pair = pairs.push(frame, 0.0);
  const server::SceneContext scene{pair.noise,
                                   server::findPlanes(pair.now.depth, pair.noise),
                                   server::SkinColors::adaptToLight(pair.now.color),
                                   {}};
  const server::ChosenStart start = server::selectInitialMask(
      pair.now, scene, {static_cast<int>(click->x()), static_cast<int>(click->y())}, {});
  CandidateScores out{1, 0.0, 0.0};
  if (!start.object) return out;
  out.chosen = server::computeOverlap(start.object->mask(), truth);
  for (const server::TrackedMask& each : start.ranked)
    out.best = std::max(out.best, server::computeOverlap(each.mask(), truth));
  return out;
}

}  // namespace

CandidateScores compareCandidates(const Recording& recording) {
  CandidateScores out;
  for (std::size_t third = 0; third < 3; ++third)
    out.add(compareAt(recording, third * recording.frames.size() / 3));
  return out;
}

}  // namespace hapticast::evaluate::held
