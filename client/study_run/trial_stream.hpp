// SPDX-License-Identifier: MIT
// Plays a recorded stream to the haptic loop of this process, without a network. A thread passes
// each frame to a Receiver when it is due, or later by a delay and a simulated network jitter:
// frame n arrives at max(arrival of n - 1, reading + delay + random time). Pictures come when
// due. Thread: the owner's, except where a function states another one.
#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include "client/desk/run_recorder.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "common/playback/recording_player.hpp"

namespace hapticast::client {

class TrialStream {
 public:
  struct Events {
    std::function<void(const VideoFrame&, const Workspace&)> picture;  ///< thread: of the stream
    std::function<void(const PlayableReliefs&)> frame;                 ///< thread: of the stream
  };
  struct Playback {
    Method method = Method::kHapticast;
    Duration delay{0};       ///< by which each frame is later than its picture
    Duration jitter{0};      ///< largest additional delay of a frame
    std::uint64_t seed = 0;  ///< of the jitter
  };

  /// Starts to play `reader` from its begin, in a loop, to `pool` and `timing`. `before`: finish()
  /// of the stream before. `recorder` (null: none) and the other references must outlive the
  /// object.
  TrialStream(StreamReader reader, const Playback& playback, const Clock& clock, FramePool& pool,
              LatestValue<StreamTiming>& timing, const StreamTiming& before, Events events,
              RunRecorder* recorder);
  TrialStream(const TrialStream&) = delete;
  TrialStream& operator=(const TrialStream&) = delete;

  /// Ends the stream, so that the force fades to zero. Returns the timing with which the next
  /// stream begins.
  StreamTiming finish();
  /// Returns whether the recording ended early, because it is damaged. Thread: any.
  [[nodiscard]] bool failed() const { return failed_; }

 private:
  struct Arrival {
    LocalTime at;
    CodedFrame frame;
  };
  void run(const std::stop_token& stop);
  void start();
  void read(LocalTime now);
  void deliver(LocalTime now);
  void onPrepared(const PreparedFrame& frame);

  const Clock& clock_;
  Playback playback_;
  Events events_;
  RunRecorder* recorder_;
  RecordingPlayer player_;
  InlinePreparation preparation_;
  Receiver receiver_;
  std::mt19937_64 random_;
  std::deque<Arrival> arrivals_;
  std::atomic<bool> failed_{false};
  std::jthread thread_;  // last: it uses everything above
};

}  // namespace hapticast::client
