// SPDX-License-Identifier: MIT
// Records the stream of this server (--record), and shows it to watchers (--live): descriptions,
// frames as they are sent to viewers that have the frame before, pictures, and the scene plan.
// proto/recording.md has the format. Thread: the encoder's, if a function states no other.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/live/message_outputs.hpp"
#include "common/time.hpp"
#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

/// The recording of a stream.
class StreamRecorder final : public StreamSink {
 public:
  /// Opens the outputs as MessageOutputs does. `media_clock` must outlive this object.
  StreamRecorder(const OutputSettings& settings, const MediaClock& media_clock);

  void describe(const StreamDescription& description) override;
  void changeKey(const DatagramKey& /*key*/) override {}
  void publish(EncodedFrame frame) override;
  void publish(EncodedVideo video) override;
  [[nodiscard]] bool videoWanted() const override;
  [[nodiscard]] bool datagramsWanted() const override { return false; }

  /// Returns whether an output needs the scene plan at `now`: once a second. Thread: the
  /// pipeline's.
  [[nodiscard]] bool isPlanDue(MediaTime now) const;
  /// Records a scene plan, as the bytes of a hapticast.proto.Plan. Thread: the pipeline's.
  void pushPlan(const std::vector<std::uint8_t>& plan, MediaTime now);

 private:
  std::vector<std::uint8_t> description_;  // encoded; empty before describe()
  std::optional<MediaTime> described_at_;  // of the last one in the file
  std::optional<MediaTime> planned_at_;    // of the last plan
  MessageOutputs outputs_;
};

}  // namespace hapticast::server
