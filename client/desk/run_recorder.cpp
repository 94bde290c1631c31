// SPDX-License-Identifier: MIT
#include "client/desk/run_recorder.hpp"

#include "common/protocol/recorded.hpp"

namespace hapticast::client {

namespace {

std::uint64_t toFileTime(LocalTime time) {
  return static_cast<std::uint64_t>(time.time_since_epoch().count());
}

}  // namespace

RunRecorder::RunRecorder(const OutputSettings& settings, const Clock& clock)
    : clock_(clock),
      outputs_(settings, "hapticast-client",
               "the motion of the hand, and the pictures of the stream", listRunChannels(),
               [&clock] { return toFileTime(clock.now()); }) {
  ticks_.reserve(kTicksPerMessage);
}

RunRecorder::~RunRecorder() { pushTicks(); }

void RunRecorder::finish() {
  pushTicks();
  outputs_.finish();
}

void RunRecorder::attachTo(Receiver& receiver) {
  receiver.onFrame([this](const AssembledFrame& frame) { onFrame(frame); });
  receiver.onTiming([this](const StreamTiming& timing, bool resets_reliefs) {
    onTiming(timing, resets_reliefs);
  });
}

void RunRecorder::push(RunChannel channel, std::span<const std::uint8_t> bytes) {
  outputs_.push(channel, toFileTime(clock_.now()), bytes);
}

void RunRecorder::pushTicks() {
  if (ticks_.empty()) return;
  if (outputs_.isWanted(kTickChannel))
    outputs_.push(kTickChannel, toFileTime(ticks_.front().time), encodeTicks(ticks_));
  ticks_.clear();
}

void RunRecorder::onSettings(const RendererSettings& settings) {
  push(kSettingsChannel, encodeSettings(settings));
}

void RunRecorder::onTick(const TickReport& report) {
  ticks_.push_back(report);
  if (ticks_.size() == kTicksPerMessage) pushTicks();
}

void RunRecorder::onControls(const UserControls& controls) {
  push(kControlsChannel, encodeControls(controls));
}

void RunRecorder::onDescription(const StreamDescription& description) {
  const std::vector<std::uint8_t> message = encode(description);
  push(kDescriptionChannel, findContent(message));
}

void RunRecorder::onTiming(const StreamTiming& timing, bool resets_reliefs) {
  push(kTimingChannel, encodeTiming({timing, resets_reliefs}));
}

void RunRecorder::onFrame(const AssembledFrame& assembled) {
  if (!outputs_.isWanted(kFrameChannel)) return;
  push(kFrameChannel, encodeFrame(assembled));
}

void RunRecorder::onPrepared(const PreparedFrame& frame) {
  if (!outputs_.isWanted(kPreparedChannel)) return;
  push(kPreparedChannel, encodePreparation({frame.id, frame.handed_over}));
}

void RunRecorder::onPicture(const VideoFrame& picture) {
  if (!outputs_.isWanted(kPictureChannel)) return;
  push(kPictureChannel, encodePictureContent(picture));
}

}  // namespace hapticast::client
