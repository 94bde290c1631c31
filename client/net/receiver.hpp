// SPDX-License-Identifier: MIT
// Network side of the reception: clock synchronisation, playout delay, counters, and the
// StreamTiming for the loop. Frames pass the assembler and the decode thread. Their lateness is
// measured when they are ready for the loop.
// Thread: network; never blocks.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "client/haptics/playback/playout.hpp"
#include "client/net/decode_thread.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/jitter_estimator.hpp"
#include "common/protocol/messages.hpp"
#include "common/sync/latest_value.hpp"
#include "common/transport/clock_sync.hpp"

namespace hapticast::client {

/// Counters of frames and reliefs.
struct ReceiverCounts {
  std::uint64_t received = 0;    ///< published to the loop
  std::uint64_t lost = 0;        ///< ids that never arrived
  std::uint64_t late = 0;        ///< arrived after their due time; published nevertheless
  std::uint64_t concealed = 0;   ///< lost, but the next frame arrived in time for interpolation
  std::uint64_t duplicates = 0;  ///< arrived twice or out of order: dropped
  std::uint64_t malformed = 0;   ///< frames with contradicting fragments: dropped
  std::uint64_t resyncs = 0;     ///< steps of the ids that no loss explains
  std::uint64_t overrun = 0;     ///< dropped: faster than the decoding
  std::uint64_t no_slot = 0;     ///< dropped: the loop held every slot of the pool
  /// Declared unchanged but never received: an object without field.
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;  ///< outside the announced picture, or too high
  std::uint64_t slices_lost = 0;       ///< slices that never arrived
  std::uint64_t slices_refused = 0;    ///< slices that could not be decoded
};

/// Processes the messages of a connection.
class Receiver {
 public:
  /// This object must be the only user of `decode_thread` and the only writer of `stream`; both
  /// must outlive it. `lookahead_frames` are the frame intervals that the interpolation needs
  /// (Hermite 1, the thesis's method 2).
  Receiver(DecodeThread& decode_thread, LatestValue<StreamTiming>& stream, int lookahead_frames);

  /// Starts a connection: new clock, new epoch; all earlier frames are void.
  void connected(const StreamDescription& description, LocalTime now);
  /// Applies a new description of the stream.
  void describe(const StreamDescription& description, LocalTime now);
  /// Adds an answered ping to the clock synchronisation.
  void pong(const Pong& pong, LocalTime arrival);
  /// Adds a frame that arrived over TCP.
  void frame(CodedFrame frame, LocalTime now);
  /// Classifies a fragment, relative to the frames so far.
  [[nodiscard]] FrameAssembler::Want setTransport(const DatagramHeader& part) const {
    return assembler_.setTransport(part);
  }
  /// Adds a fragment of the class kNew. Returns true if it completes its frame.
  bool part(const DatagramHeader& part, std::span<const std::uint8_t> payload, LocalTime now);
  /// Releases all frames that are due. Call it at nextDue().
  void release(LocalTime now);
  /// Returns the due time of the oldest incomplete frame; nullopt if none waits.
  [[nodiscard]] std::optional<LocalTime> nextDue() const;
  /// Sets the redundancy: the server sends each datagram `copies` times, a frame interval apart.
  /// Play time waits for the last one.
  void expectCopies(std::uint32_t copies, LocalTime now);
  /// Processes the result of the decode thread. The frame is ready for the loop only now, so its
  /// lateness is measured here.
  void prepared(const PreparedFrame& frame);
  void disconnected(LocalTime now);

  [[nodiscard]] const ReceiverCounts& counts() const { return counts_; }
  [[nodiscard]] const StreamTiming& stream() const { return latest_; }  ///< as last published
  [[nodiscard]] Duration clockErrorBound() const;  ///< 0 without a synchronised clock

 private:
  void publish(LocalTime now);
  void observe(const PreparedFrame& frame);
  /// Lateness at the arrival time `arrived`, beyond the server's pipeline latency.
  [[nodiscard]] Duration lateness(MediaTime media_time, LocalTime arrived) const;
  [[nodiscard]] Duration leastDelay() const;

  DecodeThread& decode_thread_;
  LatestValue<StreamTiming>& stream_;
  int lookahead_frames_;
  FrameAssembler assembler_;
  ClockSync clock_;
  JitterEstimator jitter_;
  StreamTiming latest_;
  ReceiverCounts counts_;
  bool described_ = false;
  std::uint32_t copies_ = 1;
};

}  // namespace hapticast::client
