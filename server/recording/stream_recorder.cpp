// SPDX-License-Identifier: MIT
#include "server/recording/stream_recorder.hpp"

#include <algorithm>

#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"

namespace hapticast::server {

namespace {

enum StreamChannel : std::size_t { kDescription, kFrame, kPicture, kPlan };

// A reader that begins in the middle of the file has description and plan within this time.
constexpr Duration kRepeatEvery = std::chrono::seconds(1);

std::uint64_t toFileTime(MediaTime time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

}  // namespace

StreamRecorder::StreamRecorder(const OutputSettings& settings, const MediaClock& media_clock)
    : outputs_(settings, "hapticast-server", "the pictures may show people",
               {makeChannel("/description", "hapticast.proto.StreamDescription", true),
                makeChannel("/frame", "hapticast.proto.HapticFrame"),
                makeChannel("/picture", "foxglove.CompressedImage"),
                makeChannel("/plan", "hapticast.proto.Plan", true)},
               [&media_clock] { return toFileTime(media_clock.now()); }) {}

bool StreamRecorder::videoWanted() const { return outputs_.isWanted(kPicture); }

bool StreamRecorder::isPlanDue(MediaTime now) const {
  return outputs_.isWanted(kPlan) && (!planned_at_ || now - *planned_at_ >= kRepeatEvery);
}

void StreamRecorder::pushPlan(const std::vector<std::uint8_t>& plan, MediaTime now) {
  planned_at_ = now;
  outputs_.push(kPlan, toFileTime(now), plan);
}

void StreamRecorder::describe(const StreamDescription& description) {
  description_ = encode(description);
  described_at_.reset();
}

void StreamRecorder::publish(EncodedFrame frame) {
  if (frame.delta->size() > kMaxMessageBytes) return;  // viewers do not receive it either
  const std::uint64_t time = toFileTime(frame.media_time);
  if (!described_at_ || frame.media_time - *described_at_ >= kRepeatEvery) {
    described_at_ = frame.media_time;
    outputs_.push(kDescription, time, findContent(description_));
  }
  outputs_.push(kFrame, time, findContent(*frame.delta));
}

void StreamRecorder::publish(EncodedVideo video) {
  if (!videoWanted()) return;
  const auto message = decode(*video.payload);
  outputs_.push(kPicture, toFileTime(video.media_time),
                encodePictureContent(std::get<VideoFrame>(message.value())));
}

}  // namespace hapticast::server
