// SPDX-License-Identifier: MIT
// Records a run of the client (--record), and shows it to watchers (--live): every tick with what
// the renderer read and computed, the received frames and pictures, and the settings.
// proto/recording.md has the format, replay.hpp renders a recording again. Thread: see each
// function.
#pragma once

#include <vector>

#include "client/net/receiver.hpp"
#include "client/recording/run_channels.hpp"
#include "client/recording/run_codec.hpp"
#include "common/live/message_outputs.hpp"
#include "common/protocol/messages.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// The recording of one run.
class RunRecorder {
 public:
  /// Opens the outputs as MessageOutputs does. `clock` must outlive this object.
  RunRecorder(const OutputSettings& settings, const Clock& clock);
  ~RunRecorder();
  RunRecorder(const RunRecorder&) = delete;
  RunRecorder& operator=(const RunRecorder&) = delete;

  /// Completes the outputs as MessageOutputs::finish() does. Thread: main, after all others.
  void finish();

  /// Records the frames and timings of `receiver`, which this object must outlive. Thread: main.
  void attachTo(Receiver& receiver);
  /// Records the settings. Call it once, before the first tick. Thread: main.
  void onSettings(const RendererSettings& settings);
  /// Records a tick. Thread: main.
  void onTick(const TickReport& report);
  /// Records controls of the user. Thread: main.
  void onControls(const UserControls& controls);
  /// Record an event of the stream, in the order of the events. Thread: network.
  void onDescription(const StreamDescription& description);
  void onTiming(const StreamTiming& timing, bool resets_reliefs);
  void onFrame(const AssembledFrame& assembled);
  void onPrepared(const PreparedFrame& frame);
  void onPicture(const VideoFrame& picture);

 private:
  void push(RunChannel channel, std::span<const std::uint8_t> bytes);
  void pushTicks();

  const Clock& clock_;
  std::vector<TickReport> ticks_;  // of the next message
  MessageOutputs outputs_;
};

}  // namespace hapticast::client
