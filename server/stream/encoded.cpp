// SPDX-License-Identifier: MIT
#include "server/stream/encoded.hpp"

#include <utility>

namespace hapticast::server {

namespace {
constexpr Duration kRepeatReliefs = std::chrono::seconds(1);
}

EncodedFrame FrameEncoder::encode(const HapticFrame& frame) {
  EncodedFrame encoded{frame.id, frame.media_time, nullptr, framed(hapticast::encode(frame))};
  const bool repeat = !last_full_ || frame.epoch != epoch_ ||
                      frame.media_time - *last_full_ >= kRepeatReliefs ||
                      frame.media_time < *last_full_;
  HapticFrame lean = frame;
  bool left_out = false;
  for (HapticObject& object : lean.objects) {
    if (repeat || object.changed_in_frame == frame.id || !object.relief) continue;
    object.relief = nullptr;
    left_out = true;
  }
  if (!left_out) last_full_ = frame.media_time;
  epoch_ = frame.epoch;
  encoded.lean = left_out ? framed(hapticast::encode(lean)) : encoded.full;
  return encoded;
}

EncodedVideo encodeVideo(VideoFrame video) {
  EncodedVideo encoded{video.id, video.media_time, nullptr};
  encoded.bytes = framed(hapticast::encode(std::move(video)));
  return encoded;
}

}  // namespace hapticast::server
