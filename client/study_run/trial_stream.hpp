// SPDX-License-Identifier: MIT
// Plays a recorded stream to the haptic loop of this process, without a network. A thread passes
// each frame to a Receiver when it is due, or later by a delay and a simulated network jitter:
// frame n arrives at max(arrival of n - 1, reading + delay + random time). Pictures come when
// due. Thread: the owner's, except where a function states another one.
#pragma once

#include <atomic>
#include <deque>
#include <random>
#include <string>
#include <thread>

#include "client/desk/desk.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/net/receiver.hpp"
#include "common/playback/recording_player.hpp"

namespace hapticast::client {

class TrialStream {
 public:
  struct Playback {
    Method method = Method::kHapticast;
    Duration delay{0};       ///< by which each frame is later than its picture
    Duration jitter{0};      ///< largest additional delay of a frame
    std::uint64_t seed = 0;  ///< of the jitter
  };

  /// Starts to play `reader` from its begin, in a loop, to the device, the views and the recording
  /// of `desk`, which must outlive the object. `before`: the end of the stream before.
  TrialStream(StreamReader reader, const Playback& playback, Desk& desk,
              const StreamTiming& before);
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
  UserInterface& ui_;
  RunRecorder* recorder_;  // null: no recording
  RecordingPlayer player_;
  InlinePreparation preparation_;
  Receiver receiver_;
  std::mt19937_64 random_;
  std::deque<Arrival> arrivals_;
  std::atomic<bool> failed_{false};
  std::jthread thread_;  // last: it uses everything above
};

}  // namespace hapticast::client
