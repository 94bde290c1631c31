// SPDX-License-Identifier: MIT
#include "server/vision/base/frame_pair.hpp"

#include <utility>

namespace hapticast::server {

FramePair FramePairs::push(const RgbdFrame& frame, double time_s, const cv::Mat& objects) {
  const FrameImages raw = makeFrameImages(frame, info_);
  pair_.last = std::exchange(pair_.now, raw);
  const bool first = pair_.last.color.empty();
  pair_.index = frame.index;
  pair_.last_clip_time_s =
      first || frame.clip_time_s < pair_.clip_time_s ? -1.0 : pair_.clip_time_s;
  pair_.clip_time_s = frame.clip_time_s;
  pair_.frame_s = 1.0 / info_.fps;
  pair_.has_key_masks = info_.key_masks;
  pair_.cut = cuts_.next(raw);
  if (pair_.cut) {
    pair_.last = {};
    flicker_ = DepthScaleAlignment(info_.depth_kind);
  }
  if (first || pair_.cut) {
    pair_.noise = measureNoise(raw.depth);
    pair_.noise.eight_bit = info_.depth_kind == DepthKind::kHeight;
  }
  pair_.identical = compare_ && !pair_.last.color.empty() && equalImages(raw, raw_);
  pair_.now.depth = pair_.identical
                        ? pair_.last.depth
                        : flicker_.steady(raw.depth, raw.gray, pair_.cut ? cv::Mat() : objects);
  pair_.noise.flickers = flicker_.shown();
  raw_ = raw;
  pair_.interval_s = time_s - std::exchange(time_s_, time_s);
  return pair_;
}

}  // namespace hapticast::server
