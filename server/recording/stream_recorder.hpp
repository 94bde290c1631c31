// SPDX-License-Identifier: MIT
// Records the stream of this server (--record): descriptions, frames as they are sent to viewers
// that have the frame before, and pictures. proto/recording.md has the format. Thread: the
// encoder's.
#pragma once

#include <optional>
#include <string>

#include "common/recording/recorder.hpp"
#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

/// The recording of a stream.
class StreamRecorder final : public StreamSink {
 public:
  /// Creates `file`. Throws RecordingError.
  explicit StreamRecorder(const std::string& file);
  /// Completes the file, and logs whether messages are lost.
  ~StreamRecorder() override;

  void describe(const StreamDescription& description) override;
  void changeKey(const DatagramKey& /*key*/) override {}
  void publish(EncodedFrame frame) override;
  void publish(EncodedVideo video) override;
  [[nodiscard]] bool videoWanted() const override { return true; }
  [[nodiscard]] bool datagramsWanted() const override { return false; }

 private:
  std::string file_;
  std::vector<std::uint8_t> description_;  // encoded; empty before describe()
  std::optional<MediaTime> described_at_;  // of the last one in the file
  std::optional<Recorder> recorder_;
};

}  // namespace hapticast::server
