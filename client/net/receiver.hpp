// SPDX-License-Identifier: MIT
// Makes what arrives ready for the loop: drops duplicates, counts losses, prepares reliefs, keeps
// the clock and the playout delay, fills the frame pool and publishes what is known of the stream.
// Thread: network; never waits.
#pragma once

#include <cstdint>
#include <optional>

#include "client/haptics/stream_state.hpp"
#include "client/haptics/time/frame_pool.hpp"
#include "client/net/jitter_estimator.hpp"
#include "client/net/relief_cache.hpp"
#include "common/haptic_frame.hpp"
#include "common/latest_value.hpp"
#include "common/wire/clock_sync.hpp"
#include "common/wire/messages.hpp"

namespace hapticast::client {

struct ReceiverSettings {
  Method method = Method::kHapticast;  ///< how heights are prepared
  int lookahead_frames = 1;  ///< frame intervals the interpolation needs: Hermite 1, thesis 2
};

struct ReceiverCounts {
  std::uint64_t received = 0;          ///< handed to the loop
  std::uint64_t lost = 0;              ///< ids that never came
  std::uint64_t late = 0;              ///< came after they were due (they are handed on)
  std::uint64_t concealed = 0;         ///< lost, but the next came in time to interpolate across
  std::uint64_t duplicates = 0;        ///< came twice or out of order: dropped
  std::uint64_t no_slot = 0;           ///< dropped: the loop held every slot of the pool
  std::uint64_t reliefs_missing = 0;   ///< "unchanged", but never seen: an object without field
  std::uint64_t reliefs_rejected = 0;  ///< outside the announced picture
};

class Receiver {
 public:
  /// The receiver is the one producer of `pool` and the one writer of `stream`; both outlive it.
  Receiver(FramePool& pool, LatestValue<StreamState>& stream, ReceiverSettings settings);

  /// A connection is made: new clock, new epochs, everything before is void.
  void connected(const StreamDescription& description, LocalTime now);
  /// The stream is another one from now on.
  void describe(const StreamDescription& description, LocalTime now);
  /// An answered ping.
  void pong(const Pong& pong, LocalTime arrival);
  /// A frame that has come. Its lateness is measured by `clock` when it is ready for the loop.
  void frame(HapticFrame frame, const Clock& clock);
  void disconnected(LocalTime now);

  [[nodiscard]] const ReceiverCounts& counts() const { return counts_; }
  [[nodiscard]] const StreamState& stream() const { return latest_; }  ///< as last published
  [[nodiscard]] Duration clockErrorBound() const;  ///< 0 when the clock is not known

 private:
  void startEpoch();
  void publish(LocalTime now);
  void observe(const HapticFrame& frame, LocalTime ready);
  void fill(FramePool::Slot& slot, const HapticFrame& frame);
  void fillObject(FramePool::Slot& slot, std::size_t index, const HapticObject& object,
                  std::uint64_t frame_id);

  FramePool& pool_;
  LatestValue<StreamState>& stream_;
  ReceiverSettings settings_;
  ClockSync clock_;
  JitterEstimator jitter_;
  ReliefCache reliefs_;
  StreamState latest_;
  ReceiverCounts counts_;
  bool described_ = false;
  std::uint32_t epoch_ = 0;                    // client-side, never repeats
  std::optional<std::uint32_t> server_epoch_;  // of the last frame of this connection
  std::optional<std::uint64_t> last_id_;       // of this connection
  MediaTime last_media_time_;                  // of the frame last_id_
};

}  // namespace hapticast::client
