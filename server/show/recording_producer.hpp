// SPDX-License-Identifier: MIT
// The producer of a recorded stream (--source FILE.mcap), without vision. Operators can pause it,
// seek, and change its speed and material.
#pragma once

#include <cstdint>

#include "common/playback/recording_player.hpp"
#include "server/settings/settings.hpp"
#include "server/show/producer.hpp"
#include "server/stream/encoded.hpp"

namespace hapticast::server {

/// Opens the recording of a stream `file`. Throws RecordingError with one line that names --source.
[[nodiscard]] StreamReader openRecording(const std::string& file);

/// Plays the recording `settings.source` until it ends (with --loop it repeats), or until the
/// number of frames in --frames is reached.
class RecordingProducer final : public Producer, public OperatedStream {
 public:
  /// `settings` and `clock` must outlive this object. Throws RecordingError.
  RecordingProducer(const Settings& settings, const Clock& clock);

  [[nodiscard]] const MediaClock* mediaClock() const override { return &media_clock_; }
  [[nodiscard]] StreamDescription description() const override { return description_; }
  void connect(Show& show) override { show_ = &show; }
  [[nodiscard]] OperatedStream* operated() override { return this; }
  void start() override;
  bool step() override;
  bool finish() override;

  void setPaused(bool paused) override;
  void idle() override;
  void seek(double time_s, const std::function<bool()>& ends_early) override;
  bool setSpeed(double speed) override;
  void changeMaterials(const Material& change) override;

 private:
  void publish(RecordedItem item);
  void publish(CodedFrame frame);
  /// Describes the stream to all receivers, if it changed.
  void describeStream();

  const Settings& settings_;
  RecordingPlayer player_;
  LocalMediaClock media_clock_;
  StreamDescription recorded_;     // the newest description in the recording
  StreamDescription description_;  // that of the viewers
  FrameEncoder encoder_;
  Material material_;  // operators' values
  Show* show_ = nullptr;
  std::uint64_t frames_ = 0;
};

}  // namespace hapticast::server
