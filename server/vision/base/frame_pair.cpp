// SPDX-License-Identifier: MIT
#include "server/vision/base/frame_pair.hpp"

#include <utility>

namespace hapticast::server {

FramePair FramePairs::takeIn(const RgbdFrame& frame, double time_s) {
  pair_.last = std::exchange(pair_.now, imagesOf(frame, info_));
  const bool first = pair_.last.color.empty();
  pair_.cut = cuts_.next(pair_.now);
  if (pair_.cut) pair_.last = {};
  if (first || pair_.cut) {
    pair_.noise = measureNoise(pair_.now.depth);
    pair_.noise.eight_bit = info_.depth_kind == DepthKind::kHeight;
  }
  pair_.identical = compare_ && equalImages(pair_.now, pair_.last);
  pair_.interval_s = time_s - std::exchange(time_s_, time_s);
  return pair_;
}

}  // namespace hapticast::server
