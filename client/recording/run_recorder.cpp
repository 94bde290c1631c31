// SPDX-License-Identifier: MIT
#include "client/recording/run_recorder.hpp"

#include <spdlog/spdlog.h>

#include <memory>

#include "client/recording/run_channels.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"

namespace hapticast::client {

RunRecorder::RunRecorder(const std::string& file, const Clock& clock) : file_(file), clock_(clock) {
  std::vector<McapChannel> channels;
  channels.reserve(kRunChannels);
  for (const RunChannelName& each : kRunChannelNames)
    channels.push_back(makeChannel(each.topic, each.message));
  try {
    recorder_ = std::make_unique<Recorder>(
        file, channels, [](const std::string& line) { spdlog::warn("--record {}", line); });
  } catch (const std::runtime_error& error) {
    throw RecordingError("--record " + file + ": " + error.what());
  }
  ticks_.reserve(kTicksPerMessage);
  spdlog::info("recording to {}: the motion of the hand, and the pictures of the stream", file);
}

RunRecorder::~RunRecorder() {
  pushTicks();
  spdlog::info("{} {}", file_, recorder_->finish());
}

void RunRecorder::push(std::size_t channel, std::span<const std::uint8_t> bytes) {
  recorder_->push(channel, static_cast<std::uint64_t>(clock_.now().time_since_epoch().count()),
                  bytes);
}

void RunRecorder::pushTicks() {
  if (ticks_.empty()) return;
  recorder_->push(kTickChannel,
                  static_cast<std::uint64_t>(ticks_.front().time.time_since_epoch().count()),
                  encodeTicks(ticks_));
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
  push(kFrameChannel, encodeFrame(assembled));
}

void RunRecorder::onPrepared(const PreparedFrame& frame) {
  push(kPreparedChannel, encodePreparation({frame.id, frame.handed_over}));
}

void RunRecorder::onPicture(const VideoFrame& picture) {
  push(kPictureChannel, encodePictureContent(picture));
}

}  // namespace hapticast::client
