// SPDX-License-Identifier: MIT
#include "common/live/message_outputs.hpp"

#include <spdlog/spdlog.h>

#include <stdexcept>
#include <utility>

#include "common/protocol/recorded.hpp"
#include "common/recording/schemas.hpp"

namespace hapticast {

namespace {

LogLevel toLevel(spdlog::level::level_enum level) {
  if (level >= spdlog::level::err) return LogLevel::kError;
  if (level == spdlog::level::warn) return LogLevel::kWarning;
  return level == spdlog::level::info ? LogLevel::kInfo : LogLevel::kDebug;
}

}  // namespace

MessageOutputs::MessageOutputs(const OutputSettings& settings, const std::string& name,
                               const std::string& warning, std::vector<McapChannel> channels,
                               std::function<std::uint64_t()> now_ns)
    : file_(settings.record) {
  const std::size_t log_channel = channels.size();
  channels.push_back(makeChannel("/log", "foxglove.Log"));
  if (!file_.empty()) {
    openRecorder(channels);
    spdlog::info("recording to {}: {}", file_, warning);
  }
  if (settings.live) {
    live_ = std::make_unique<LiveServer>(*settings.live, name, std::move(channels));
    spdlog::info("watch the messages at ws://{} with Lichtblick or Foxglove: {}",
                 toString(live_->address()), warning);
  }
  log_.emplace([this, log_channel, name, now_ns = std::move(now_ns)](
                   spdlog::level::level_enum level, std::string_view text) {
    if (!isWanted(log_channel)) return;
    const std::uint64_t time_ns = now_ns();
    push(log_channel, time_ns, encodeLogContent(time_ns, toLevel(level), text, name));
  });
}

void MessageOutputs::openRecorder(const std::vector<McapChannel>& channels) {
  try {
    recorder_ = std::make_unique<Recorder>(
        file_, channels, [](const std::string& line) { spdlog::warn("--record {}", line); },
        clock_);
  } catch (const std::runtime_error& error) {
    throw RecordingError("--record " + file_ + ": " + error.what());
  }
}

MessageOutputs::~MessageOutputs() {
  log_.reset();
  live_.reset();
  if (!recorder_) return;
  const std::string result = recorder_->finish();
  spdlog::log(recorder_->isComplete() ? spdlog::level::info : spdlog::level::warn, "{} {}", file_,
              result);
}

void MessageOutputs::finish() {
  log_.reset();
  live_.reset();
  const std::unique_ptr<Recorder> recorder = std::move(recorder_);
  if (!recorder) return;
  const std::string result = recorder->finish();
  if (!recorder->isComplete()) throw RecordingError("--record " + file_ + ": " + result);
  spdlog::info("{} {}", file_, result);
}

void MessageOutputs::push(std::size_t channel, std::uint64_t time_ns,
                          std::span<const std::uint8_t> data) {
  if (recorder_) recorder_->push(channel, time_ns, data);
  if (live_) live_->push(channel, time_ns, data);
}

}  // namespace hapticast
