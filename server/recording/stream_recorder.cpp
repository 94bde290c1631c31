// SPDX-License-Identifier: MIT
#include "server/recording/stream_recorder.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>

#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"

namespace hapticast::server {

namespace {

enum Channel : std::size_t { kDescription, kFrame, kPicture };

// A reader that begins in the middle of the file has the description within this time.
constexpr Duration kDescribeEvery = std::chrono::seconds(1);

std::uint64_t toFileTime(MediaTime time) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(time.time_since_epoch().count(), 0));
}

}  // namespace

StreamRecorder::StreamRecorder(const std::string& file) : file_(file) {
  try {
    recorder_.emplace(file,
                      std::vector{makeChannel("/description", "hapticast.proto.StreamDescription"),
                                  makeChannel("/frame", "hapticast.proto.HapticFrame"),
                                  makeChannel("/picture", "foxglove.CompressedImage")},
                      [](const std::string& line) { spdlog::warn("--record {}", line); });
  } catch (const std::runtime_error& error) {
    throw RecordingError("--record " + file + ": " + error.what());
  }
  spdlog::info("recording to {}: the pictures may show people", file);
}

StreamRecorder::~StreamRecorder() { spdlog::info("{} {}", file_, recorder_->finish()); }

void StreamRecorder::describe(const StreamDescription& description) {
  description_ = encode(description);
  described_at_.reset();
}

void StreamRecorder::publish(EncodedFrame frame) {
  if (frame.delta->size() > kMaxMessageBytes) return;  // viewers do not receive it either
  const std::uint64_t time = toFileTime(frame.media_time);
  if (!described_at_ || frame.media_time - *described_at_ >= kDescribeEvery) {
    described_at_ = frame.media_time;
    recorder_->push(kDescription, time, findContent(description_));
  }
  recorder_->push(kFrame, time, findContent(*frame.delta));
}

void StreamRecorder::publish(EncodedVideo video) {
  const auto message = decode(*video.payload);
  recorder_->push(kPicture, toFileTime(video.media_time),
                  encodePictureContent(std::get<VideoFrame>(message.value())));
}

}  // namespace hapticast::server
