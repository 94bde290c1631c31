// SPDX-License-Identifier: MIT
#include "client/commands/replay_outputs.hpp"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "client/desk/user_interface.hpp"
#include "client/recording/run_codec.hpp"
#include "common/protocol/recorded.hpp"
#include "common/recording/recorder.hpp"

namespace hapticast::client {

namespace {

constexpr std::uint64_t kUpdateEvery_ticks = 10;      // as the main loop of a run
constexpr std::chrono::milliseconds kWaitForView{5};  // chosen

/// Returns `settings` without the views that need a user.
Settings keepFiles(Settings settings) {
  settings.view = ViewChoice::kOff;
  settings.sound = false;
  return settings;
}

}  // namespace

ReplayRecording::ReplayRecording(const std::string& file) : file_(file) {
  try {
    writer_.emplace(file, listRunChannels());
  } catch (const std::runtime_error& error) {
    throw RecordingError("--record " + file + ": " + error.what());
  }
}

void ReplayRecording::onTick(const TickReport& report) {
  ticks_.push_back(report);
  if (ticks_.size() == kTicksPerMessage) writeTicks();
}

void ReplayRecording::writeTicks() {
  if (ticks_.empty()) return;
  writer_->write(kTickChannel,
                 static_cast<std::uint64_t>(ticks_.front().time.time_since_epoch().count()),
                 encodeTicks(ticks_));
  ticks_.clear();
}

void ReplayRecording::onMessage(RunChannel channel, std::uint64_t time_ns,
                                std::span<const std::uint8_t> data) {
  writer_->write(channel, time_ns, data);
}

void ReplayRecording::finish() {
  writeTicks();
  if (!writer_->finish() || writer_->lost() > 0)
    throw RecordingError("--record " + file_ + ": " + writer_->problem());
}

ReplayViews::ReplayViews(Settings settings) : views_(openViews(keepFiles(std::move(settings)))) {}

void ReplayViews::onTick(const TickReport& report) {
  for (const auto& view : views_) view->onReport(report);
  if (report.tick % kUpdateEvery_ticks == 0) update();
}

void ReplayViews::update() {
  for (const auto& view : views_) (void)view->update(state_);
  const auto isBusy = [](const auto& view) { return view->isBusy(); };
  while (std::any_of(views_.begin(), views_.end(), isBusy))
    std::this_thread::sleep_for(kWaitForView);
}

void ReplayViews::onMessage(RunChannel channel, std::span<const std::uint8_t> data) {
  if (views_.empty()) return;
  if (channel == kControlsChannel) {
    if (const auto controls = decodeControls(data); controls.ok()) state_.user = controls.value();
  } else if (channel == kDescriptionChannel) {
    const auto description = decodeDescriptionContent(data);
    if (!description.ok()) return;
    workspace_ = description.value().workspace;
    state_.stream.connected = true;
    state_.stream.fps = description.value().fps;
  } else if (channel == kPictureChannel && workspace_) {
    auto picture = decodePictureContent(data);
    if (!picture.ok()) return;
    for (const auto& view : views_) view->onPicture(picture.value(), *workspace_);
  }
}

bool ReplayViews::finish() {
  update();
  return finishViews(views_);
}

}  // namespace hapticast::client
