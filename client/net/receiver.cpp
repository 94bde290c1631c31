// SPDX-License-Identifier: MIT
#include "client/net/receiver.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {
// A pause of the stream is no jitter.
constexpr Duration kLargestGap = std::chrono::seconds(1);
// A frame waits for its last fragments by 1/kWaitsOfInterval of a frame interval longer than play
// time requires. Meanwhile dead reckoning continues the frame before; the hand notices that less
// than a missing fragment (measured by hapticast-evaluate network).
constexpr int kWaitsOfInterval = 4;
// The fragments of a frame leave the server one after the other. After a late one the rest may
// still be on its way. Chosen: a large frame over 100 Mbit/s.
constexpr Duration kBackToBack = std::chrono::milliseconds(2);
}  // namespace

Receiver::Receiver(FrameSink& sink, LatestValue<StreamTiming>& stream, int lookahead_frames,
                   Duration max_delay, const StreamTiming& before)
    : sink_(sink), stream_(stream), lookahead_frames_(lookahead_frames), jitter_(max_delay) {
  latest_.number = before.number;
  assembler_.continueEpochs(before.first_epoch);
}

StreamTiming Receiver::findEnd() const {
  StreamTiming end = latest_;
  end.first_epoch = assembler_.epoch();
  return end;
}

void Receiver::connected(const StreamDescription& description, LocalTime now) {
  clock_.reset();
  server_clock_error_ = {};
  assembler_.restart();
  contradicted_ = false;
  latest_.first_epoch = assembler_.epoch();
  described_ = false;  // announcements before this one belong to another connection
  describe(description, now);
}

void Receiver::describe(const StreamDescription& description, LocalTime now) {
  if (!described_ || !(description.workspace == latest_.workspace)) {
    sink_.reset(description.workspace);
    was_reset_ = true;
  }
  if (!described_ || description.pipeline_latency != latest_.pipeline_latency) jitter_.reset(now);
  described_ = true;
  latest_.pipeline_latency = description.pipeline_latency;
  latest_.frame_interval = fromSeconds(1.0 / description.fps);
  latest_.workspace = description.workspace;
  latest_.largest_acceleration_mm_s2 = description.largest_acceleration_mm_s2;
  latest_.author_mass_kg = description.mass_kg.value_or(0.0);
  publish(now);
}

void Receiver::disconnected(LocalTime now) {
  described_ = false;
  publish(now);
}

void Receiver::pong(const Pong& pong, LocalTime arrival) {
  clock_.add(pong.t0, pong.t1, pong.t2, arrival);
  server_clock_error_ = pong.error;
  publish(arrival);
}

void Receiver::publish(LocalTime now) {
  latest_.connected = described_ && clock_.ready();
  if (latest_.connected) {
    const Duration before = latest_.clock_offset;
    latest_.clock_offset = clock_.offset(now);
    jitter_.shift(latest_.clock_offset - before);
  }
  latest_.playout_delay_target = jitter_.delay(leastDelay());
  ++latest_.number;
  if (on_timing_) on_timing_(latest_, std::exchange(was_reset_, false));
  stream_.store(latest_);
}

Duration Receiver::clockErrorBound() const {
  return clock_.ready() ? clock_.errorBound() + server_clock_error_ : Duration::zero();
}

Duration Receiver::leastDelay() const {
  return latest_.frame_interval * (lookahead_frames_ + static_cast<int>(copies_) - 1);
}

void Receiver::expectCopies(std::uint32_t copies, LocalTime now) {
  if (copies == copies_) return;  // usual case: called in every cycle
  copies_ = copies;
  publish(now);
}

void Receiver::frame(CodedFrame frame, LocalTime now) {
  if (!assembler_.add(std::move(frame), now)) ++counts_.duplicates;
  countContradiction();
  release(now);
}

bool Receiver::part(const DatagramHeader& part, std::span<const std::uint8_t> payload,
                    LocalTime now) {
  const auto added = assembler_.add(part, payload, now);
  if (!added.ok()) ++counts_.malformed;
  countContradiction();
  release(now);
  return added.ok() && added.value();
}

void Receiver::countContradiction() {
  if (assembler_.contradicted() && !contradicted_) ++counts_.contradictions;
  contradicted_ = assembler_.contradicted();
}

std::optional<LocalTime> Receiver::nextDue() const {
  const auto last = assembler_.findLastLeft();
  const auto came = assembler_.oldestCame();
  if (!came || !last || !clock_.ready()) return std::nullopt;
  const Duration ahead = latest_.frame_interval * (lookahead_frames_ - 1);
  const LocalTime needed(last->time_since_epoch() - ahead - latest_.clock_offset +
                         latest_.pipeline_latency + latest_.playout_delay_target +
                         latest_.frame_interval / kWaitsOfInterval);
  return std::max(needed, *came + kBackToBack);
}

void Receiver::release(LocalTime now) {
  // Without a synchronised clock nothing is played, so no frame has to wait.
  const auto due = [&] { return !clock_.ready() || nextDue().value_or(now) <= now; };
  while (auto assembled = assembler_.next(due())) {
    assembled->place.left = now;
    counts_.lost += assembled->place.lost;
    if (assembled->place.resync) {
      ++counts_.resyncs;
      sink_.reset(latest_.workspace);  // "unchanged since frame M" referred to other frames
    }
    if (on_frame_) on_frame_(*assembled);
    counts_.overrun += sink_.push(std::move(*assembled));
  }
  while (const auto late = assembler_.takeLate()) {
    if (!clock_.ready()) continue;
    ++counts_.late;
    addArrival(late->arrived, late->media_time, latest_.frame_interval);
  }
}

void Receiver::addPrepared(const PreparedFrame& frame) {
  ++(frame.handed_over ? counts_.received : counts_.no_slot);
  counts_.reliefs_missing += frame.reliefs_missing;
  counts_.reliefs_rejected += frame.reliefs_rejected;
  counts_.slices_lost += frame.slices_lost;
  counts_.slices_refused += frame.slices_refused;
  // The age of a connection's first frame is arbitrary, because the server sends it at the
  // connection. A frame of the connection before is no measure of this one.
  if (!frame.place.first && frame.place.epoch >= latest_.first_epoch) observe(frame);
  publish(frame.ready);
}

Duration Receiver::lateness(MediaTime media_time, LocalTime arrived) const {
  return MediaTime(arrived.time_since_epoch() + latest_.clock_offset) - media_time -
         latest_.pipeline_latency;
}

void Receiver::observe(const PreparedFrame& frame) {
  // A frame that left incomplete is no measure of the arrivals.
  if (!clock_.ready() || !frame.place.arrived) return;
  const LocalTime ready = *frame.place.arrived + (frame.ready - frame.place.left);
  // Interpolation needs this frame from the time when play time reaches the frame before.
  const Duration gap = std::clamp(frame.place.gap, Duration{0}, kLargestGap);
  if (addArrival(ready, frame.place.media_time, gap) > latest_.playout_delay_target) {
    ++counts_.late;
  } else {
    counts_.concealed += frame.place.lost;
  }
}

Duration Receiver::addArrival(LocalTime at, MediaTime media_time, Duration gap) {
  const Duration late = lateness(media_time, at);
  const Duration needed = late + gap * lookahead_frames_;
  counts_.too_late += needed > jitter_.maxDelay();
  jitter_.add({at, needed, at - late - gap}, latest_.frame_interval);
  return needed;
}

}  // namespace hapticast::client
