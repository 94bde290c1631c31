// SPDX-License-Identifier: MIT
#include "server/stream/encoded.hpp"

#include <utility>

namespace hapticast::server {

namespace {

// The protocol promises that a viewer that lost a relief receives it again within a second.
constexpr Duration kRepeatReliefs = std::chrono::seconds(1);

SharedBytes encodeFrame(const CodedFrame& frame, FrameSigner* signer) {
  return signer != nullptr ? signer->signMessage(frame) : encodeShared(frame);
}

}  // namespace

SharedBytes LazyKeyFrame::payload() {
  const std::lock_guard lock(mutex_);
  if (!payload_) {
    payload_ = encodeFrame(*frame_, signer_);
    frame_.reset();
  }
  return payload_;
}

EncodedFrame FrameEncoder::encode(const HapticFrame& frame, const SliceSettings& slices,
                                  FrameSigner* signer, bool datagrams) {
  return encode(coder_.code(frame, slices), signer, datagrams);
}

EncodedFrame FrameEncoder::encode(CodedFrame frame, FrameSigner* signer, bool datagrams) {
  relief_bytes_.clear();
  for (const CodedObject& object : frame.objects)
    relief_bytes_[object.id] += object.relief ? object.relief->bytes() : 0;
  EncodedFrame encoded{frame.epoch, frame.id, frame.media_time, nullptr, nullptr};
  const bool hole = followsHole(frame.media_time);
  const bool repeat = hole || !last_key_frame_ || frame.epoch != epoch_ ||
                      frame.media_time - *last_key_frame_ >= kRepeatReliefs ||
                      frame.media_time < *last_key_frame_;
  CodedFrame lean = frame;
  bool left_out = false;
  for (CodedObject& object : lean.objects) {
    if (repeat || object.changed_in_frame == frame.id || !object.relief) continue;
    object.relief = nullptr;
    left_out = true;
  }
  if (!left_out) last_key_frame_ = frame.media_time;
  epoch_ = frame.epoch;
  const bool wanted = signer != nullptr && datagrams;
  if (wanted) encoded.datagrams = signer->signDatagrams(lean);
  encoded.too_many_datagrams = wanted && !encoded.datagrams;
  encoded.delta = encodeFrame(lean, signer);
  encoded.key_frame = left_out ? std::make_shared<LazyKeyFrame>(std::move(frame), signer)
                               : std::make_shared<LazyKeyFrame>(encoded.delta);
  return encoded;
}

bool FrameEncoder::followsHole(MediaTime media_time) {
  const Duration gap = media_time - std::exchange(last_media_time_, media_time);
  return gap > std::exchange(last_gap_, gap) + kStaleAge;
}

EncodedVideo encodeVideo(VideoFrame video) {
  EncodedVideo encoded{video.id, video.media_time, nullptr};
  encoded.payload = encodeShared(std::move(video));
  return encoded;
}

}  // namespace hapticast::server
