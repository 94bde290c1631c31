// SPDX-License-Identifier: MIT
#include "client/net/receiver.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {
// A pause of the stream is no jitter.
constexpr Duration kLargestGap = std::chrono::seconds(1);
}  // namespace

Receiver::Receiver(Preparer& preparer, LatestValue<StreamState>& stream, int lookahead_frames)
    : preparer_(preparer), stream_(stream), lookahead_frames_(lookahead_frames) {}

void Receiver::connected(const StreamDescription& description, LocalTime now) {
  clock_.reset();
  assembler_.restart();
  latest_.first_epoch = assembler_.epoch();
  described_ = false;  // whatever was announced before came over another connection
  describe(description, now);
}

void Receiver::describe(const StreamDescription& description, LocalTime now) {
  if (!described_ || !(description.workspace == latest_.workspace)) {
    preparer_.reset(description.workspace);
  }
  if (!described_ || description.pipeline_latency != latest_.pipeline_latency) jitter_.reset();
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
  publish(arrival);
}

void Receiver::publish(LocalTime now) {
  latest_.connected = described_ && clock_.ready();
  if (latest_.connected) latest_.clock_offset = clock_.offset(now);
  latest_.playout_delay_target = jitter_.delay(latest_.frame_interval * lookahead_frames_);
  stream_.store(latest_);
}

Duration Receiver::clockErrorBound() const {
  return clock_.ready() ? clock_.errorBound() : Duration::zero();
}

void Receiver::frame(CodedFrame frame) {
  auto assembled = assembler_.add(std::move(frame));
  if (!assembled) {
    ++counts_.duplicates;
    return;
  }
  counts_.lost += assembled->place.lost;
  if (assembled->place.resync) {
    ++counts_.resyncs;
    preparer_.reset(latest_.workspace);  // "unchanged since frame M" was said of other frames
  }
  counts_.overrun += preparer_.push(std::move(*assembled));
}

void Receiver::prepared(const PreparedFrame& frame) {
  ++(frame.handed_on ? counts_.received : counts_.no_slot);
  counts_.reliefs_missing += frame.reliefs_missing;
  counts_.reliefs_rejected += frame.reliefs_rejected;
  counts_.slices_lost += frame.slices_lost;
  counts_.slices_refused += frame.slices_refused;
  // The first frame of a connection is sent whenever the viewer comes, so that its age says nothing
  // of the network; a frame of the connection before says nothing of this one.
  if (!frame.place.first && frame.place.epoch >= latest_.first_epoch) observe(frame);
  publish(frame.ready);
}

void Receiver::observe(const PreparedFrame& frame) {
  if (!clock_.ready()) return;
  const MediaTime media_now(frame.ready.time_since_epoch() + clock_.offset(frame.ready));
  const Duration lateness = media_now - frame.place.media_time - latest_.pipeline_latency;
  // When play time reaches the frame before, interpolation begins to need this one.
  const Duration gap = std::clamp(frame.place.gap, Duration{0}, kLargestGap);
  const Duration needed = lateness + gap * lookahead_frames_;
  if (needed > latest_.playout_delay_target) {
    ++counts_.late;
  } else {
    counts_.concealed += frame.place.lost;
  }
  jitter_.add(frame.ready, needed);
}

}  // namespace hapticast::client
