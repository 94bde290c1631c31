// SPDX-License-Identifier: MIT
#include "client/study_run/trial_stream.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "common/transport/clock_sync.hpp"

namespace hapticast::client {

namespace {

constexpr auto kDeliveryPeriod = std::chrono::milliseconds(1);  // that of the haptic loop

// The recording plays on the clock of this process: the offset of the media clock is zero.
MediaTime toMedia(LocalTime time) { return MediaTime(time.time_since_epoch()); }

}  // namespace

TrialStream::TrialStream(StreamReader reader, const Playback& playback, Desk& desk,
                         const StreamTiming& before)
    : clock_(desk.clock()),
      playback_(playback),
      ui_(desk.ui()),
      recorder_(desk.recorder()),
      player_(std::move(reader), true),
      preparation_(desk.local().pool, clock_, playback.method,
                   [this](const PreparedFrame& frame) { onPrepared(frame); }),
      receiver_(preparation_, desk.local().stream, playback.method == Method::kThesis ? 2 : 1,
                JitterEstimator::kMaxDelay, before),
      random_(playback.seed) {
  if (recorder_ != nullptr) recorder_->attachTo(receiver_);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

StreamTiming TrialStream::finish() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return receiver_.findEnd();
}

void TrialStream::run(const std::stop_token& stop) {
  start();
  while (!stop.stop_requested()) {
    const LocalTime now = clock_.now();
    read(now);
    deliver(now);
    std::this_thread::sleep_for(kDeliveryPeriod);
  }
  receiver_.disconnected(clock_.now());
}

void TrialStream::start() {
  const LocalTime now = clock_.now();
  const StreamDescription description = describePlayback(player_.reader().description(), 1.0, "");
  if (recorder_ != nullptr) recorder_->onDescription(description);
  receiver_.connected(description, now);
  for (std::size_t i = 0; i < ClockSync::kBurst; ++i)
    receiver_.pong({now, toMedia(now), toMedia(now), {}}, now);
}

/// Reads what is due. A frame may arrive later.
void TrialStream::read(LocalTime now) {
  while (true) {
    const auto due = player_.prepare(toMedia(now));
    if (!due || *due > toMedia(now)) break;
    RecordedItem item = player_.take();
    if (auto* const frame = std::get_if<CodedFrame>(&item)) {
      const auto largest = static_cast<std::uint64_t>(playback_.jitter.count());
      const auto extra = Duration(static_cast<Duration::rep>(random_() % (largest + 1)));
      const LocalTime earliest = arrivals_.empty() ? now : arrivals_.back().at;
      arrivals_.push_back({std::max(earliest, now + playback_.delay + extra), std::move(*frame)});
    } else if (const auto* const picture = std::get_if<VideoFrame>(&item)) {
      if (recorder_ != nullptr) recorder_->onPicture(*picture);
      ui_.onPicture(*picture, receiver_.stream().workspace);
    } else if (const auto* const description = std::get_if<StreamDescription>(&item)) {
      receiver_.describe(describePlayback(*description, 1.0, ""), now);
    }
  }
  if (!player_.problem().empty()) failed_ = true;
}

void TrialStream::deliver(LocalTime now) {
  while (!arrivals_.empty() && arrivals_.front().at <= now) {
    CodedFrame frame = std::move(arrivals_.front().frame);
    arrivals_.pop_front();
    receiver_.frame(std::move(frame), now);
  }
  receiver_.release(now);
  while (preparation_.step()) {
  }
}

void TrialStream::onPrepared(const PreparedFrame& frame) {
  if (recorder_ != nullptr) recorder_->onPrepared(frame);
  receiver_.addPrepared(frame);
  ui_.onFrame(frame.playable);
}

}  // namespace hapticast::client
