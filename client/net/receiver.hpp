// SPDX-License-Identifier: MIT
// Network side of the reception. It synchronises the clock, adapts the playout delay, counts
// frames, and writes the StreamTiming for the loop. It passes each frame to the assembler and then
// to the decode thread. It measures the lateness of a frame when the frame is ready for the loop.
// Thread: network; never blocks.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "client/haptics/playback/playout.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/frame_preparer.hpp"
#include "client/net/jitter_estimator.hpp"
#include "common/protocol/messages.hpp"
#include "common/sync/latest_value.hpp"
#include "common/transport/clock_sync.hpp"

namespace hapticast::client {

/// Counters of frames and reliefs.
struct ReceiverCounts {
  std::uint64_t received = 0;  ///< published to the loop
  std::uint64_t lost = 0;      ///< frames whose id never arrived
  /// Frames that arrived after they were due; the loop receives them nevertheless.
  std::uint64_t late = 0;
  /// Frames that arrived too late for the largest playout delay.
  std::uint64_t too_late = 0;
  /// Number of lost frames before a frame that arrived in time for the interpolation.
  std::uint64_t concealed = 0;
  std::uint64_t duplicates = 0;  ///< frames that arrived twice or out of order: dropped
  /// Connections in which two different versions of one frame arrived. The client drops the frames
  /// of such a connection.
  std::uint64_t contradictions = 0;
  std::uint64_t malformed = 0;  ///< frames whose fragments contradict each other: dropped
  std::uint64_t resyncs = 0;    ///< number of steps of the ids that no loss explains
  std::uint64_t overrun = 0;  ///< frames dropped because they arrived faster than they were decoded
  /// Frames that were dropped after their decoding, because FramePool had no free slot.
  std::uint64_t no_slot = 0;
  /// Reliefs that a frame declares unchanged but that the server never sent. Their objects have no
  /// relief. A relief that the network may have lost does not count.
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;  ///< reliefs outside the picture of the stream, or too high
  std::uint64_t slices_lost = 0;       ///< slices that never arrived
  std::uint64_t slices_refused = 0;    ///< slices that could not be decoded
};

/// Processes the messages of one connection.
class Receiver {
 public:
  /// The object passes frames to `sink` and writes the timing of the stream to
  /// `stream`. No other object may do so. Both must outlive this object. `lookahead_frames` is the
  /// number of frame intervals that the interpolation needs in advance (Hermite: 1, the thesis's
  /// method: 2). `max_delay` is the largest playout delay. `before` is the findEnd() of another
  /// Receiver that wrote to `stream` until now: numbers and epochs continue from there.
  Receiver(FrameSink& sink, LatestValue<StreamTiming>& stream, int lookahead_frames,
           Duration max_delay = JitterEstimator::kMaxDelay, const StreamTiming& before = {});

  /// Sets a function that receives every frame before the decode thread does, in their order.
  void onFrame(std::function<void(const AssembledFrame&)> on_frame) {
    on_frame_ = std::move(on_frame);
  }
  /// Sets a function that receives every StreamTiming before the loop does. Its second argument is
  /// true if the decode thread was reset before it.
  void onTiming(std::function<void(const StreamTiming&, bool)> on_timing) {
    on_timing_ = std::move(on_timing);
  }
  /// Starts a connection with this description of the stream. The clock is synchronised again, and
  /// all frames before the connection are dropped.
  void connected(const StreamDescription& description, LocalTime now);
  /// Applies a new description of the stream during the connection.
  void describe(const StreamDescription& description, LocalTime now);
  /// Adds an answered ping to the clock synchronisation.
  void pong(const Pong& pong, LocalTime arrival);
  /// Adds a frame that arrived over TCP.
  void frame(CodedFrame frame, LocalTime now);
  /// Returns the class of a fragment, by the frames that arrived so far.
  [[nodiscard]] FrameAssembler::Want classify(const DatagramHeader& part) const {
    return assembler_.classify(part);
  }
  /// Adds a fragment of the class kNew. Returns true if the fragment completes its frame.
  bool part(const DatagramHeader& part, std::span<const std::uint8_t> payload, LocalTime now);
  /// Passes all frames that are complete or due to the decode thread. Call it at the time that
  /// nextDue() returns.
  void release(LocalTime now);
  /// Returns the time when the oldest incomplete frame is due. Returns nullopt if no frame waits.
  [[nodiscard]] std::optional<LocalTime> nextDue() const;
  /// Sets the redundancy: the server sends each datagram `copies` times, one frame interval apart.
  /// The playout delay then covers the last send.
  void expectCopies(std::uint32_t copies, LocalTime now);
  /// Processes the result of the decode thread for one frame. The frame is ready for the loop only
  /// now, so its lateness is measured here.
  void addPrepared(const PreparedFrame& frame);
  /// Marks the connection as ended, in the timing for the loop.
  void disconnected(LocalTime now);

  [[nodiscard]] const ReceiverCounts& counts() const { return counts_; }
  /// Returns the StreamTiming that the loop received last.
  [[nodiscard]] const StreamTiming& stream() const { return latest_; }
  /// Returns stream(), with the last epoch in use as the first one: where another Receiver begins.
  [[nodiscard]] StreamTiming findEnd() const;
  /// Returns a bound on the error of the clock offset: the client's own error plus the error that
  /// the server states for its clock. Returns 0 without a synchronised clock.
  [[nodiscard]] Duration clockErrorBound() const;

 private:
  void publish(LocalTime now);
  void countContradiction();
  void observe(const PreparedFrame& frame);
  /// Adds the arrival of the frame with `media_time` to the jitter. `gap`: media time since the
  /// frame before. Returns the playout delay with which the frame would be in time.
  Duration addArrival(LocalTime at, MediaTime media_time, Duration gap);
  /// Returns the lateness of a frame that arrived at `arrived`: the media time of the arrival,
  /// minus `media_time`, minus the pipeline latency.
  [[nodiscard]] Duration lateness(MediaTime media_time, LocalTime arrived) const;
  [[nodiscard]] Duration leastDelay() const;

  FrameSink& sink_;
  LatestValue<StreamTiming>& stream_;
  int lookahead_frames_;
  std::function<void(const AssembledFrame&)> on_frame_;
  std::function<void(const StreamTiming&, bool)> on_timing_;
  bool was_reset_ = false;  // the decode thread, since the last StreamTiming
  FrameAssembler assembler_;
  ClockSync clock_;
  Duration server_clock_error_{0};  // of the newest pong
  JitterEstimator jitter_;
  StreamTiming latest_;
  ReceiverCounts counts_;
  bool described_ = false;
  bool contradicted_ = false;  // counted for this connection
  std::uint32_t copies_ = 1;
};

}  // namespace hapticast::client
