// SPDX-License-Identifier: MIT
// The network's side of receiving: keeps the clock and the playout delay, counts, and publishes
// what is known of the stream. Frames go through the assembler to the preparer and are judged when
// they are ready for the loop. Thread: network; never waits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "client/haptics/stream_timing.hpp"
#include "client/net/decode_thread.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/jitter_estimator.hpp"
#include "common/protocol/messages.hpp"
#include "common/sync/latest_value.hpp"
#include "common/transport/clock_sync.hpp"

namespace hapticast::client {

struct ReceiverCounts {
  std::uint64_t received = 0;          ///< handed to the loop
  std::uint64_t lost = 0;              ///< ids that never came
  std::uint64_t late = 0;              ///< came after they were due (they are handed on)
  std::uint64_t concealed = 0;         ///< lost, but the next came in time to interpolate across
  std::uint64_t duplicates = 0;        ///< came twice or out of order: dropped
  std::uint64_t malformed = 0;         ///< frames of parts that contradict each other: dropped
  std::uint64_t resyncs = 0;           ///< jumps of the ids that no loss explains
  std::uint64_t overrun = 0;           ///< dropped: they came faster than they can be prepared
  std::uint64_t no_slot = 0;           ///< dropped: the loop held every slot of the pool
  std::uint64_t reliefs_missing = 0;   ///< "unchanged", but never seen: an object without field
  std::uint64_t reliefs_rejected = 0;  ///< outside the announced picture, or too high
  std::uint64_t slices_lost = 0;       ///< parts of reliefs that never came
  std::uint64_t slices_refused = 0;    ///< parts of reliefs that could not be decoded
};

class Receiver {
 public:
  /// The receiver is the one that feeds `preparer` and the one writer of `stream`; both outlive it.
  /// `lookahead_frames`: frame intervals that the interpolation needs (Hermite 1, the thesis 2).
  Receiver(DecodeThread& decode_thread, LatestValue<StreamTiming>& stream, int lookahead_frames);

  /// A connection is made: new clock, new epochs, everything before is void.
  void connected(const StreamDescription& description, LocalTime now);
  /// The stream is another one from now on.
  void describe(const StreamDescription& description, LocalTime now);
  /// An answered ping.
  void pong(const Pong& pong, LocalTime arrival);
  /// A frame that has come over TCP.
  void frame(CodedFrame frame, LocalTime now);
  /// What a datagram is to the frames so far.
  [[nodiscard]] FrameAssembler::Want setTransport(const DatagramHeader& part) const {
    return assembler_.setTransport(part);
  }
  /// A part that is wanted; true where its frame is whole now.
  bool part(const DatagramHeader& part, std::span<const std::uint8_t> payload, LocalTime now);
  /// Lets go what has to leave by now; to be called at nextDue().
  void release(LocalTime now);
  /// When a frame of which parts are missing has to leave; nothing while none waits.
  [[nodiscard]] std::optional<LocalTime> nextDue() const;
  /// Of each datagram so many copies come, a frame apart: play time waits for the last.
  void expectCopies(std::uint32_t copies, LocalTime now);
  /// What the preparer says of a frame: only now the loop has it, so that its lateness is measured
  /// now.
  void prepared(const PreparedFrame& frame);
  void disconnected(LocalTime now);

  [[nodiscard]] const ReceiverCounts& counts() const { return counts_; }
  [[nodiscard]] const StreamTiming& stream() const { return latest_; }  ///< as last published
  [[nodiscard]] Duration clockErrorBound() const;  ///< 0 when the clock is not known

 private:
  void publish(LocalTime now);
  void observe(const PreparedFrame& frame);
  /// How late something was that came at `arrived`, beside what the server takes.
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
