// SPDX-License-Identifier: MIT
// Plays a recorded stream in real time, without vision. The first pass has the recorded media
// times, ids and epochs. After each discontinuity (a loop, a seek, a pause, another speed, a gap, a
// machine that stood still) the stream continues in a new epoch: media times and ids count on, and
// the reliefs count as new. At another speed s, velocities are multiplied by s, accelerations by
// s^2. Callers pass all times as arguments: the class has no thread and no clock. Thread: one.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "server/recording/stream_reader.hpp"

namespace hapticast::server {

/// The playback of one recording for one stream.
class RecordingPlayer {
 public:
  /// Pause between two frames of the recording that playback skips. Chosen: an operator who paused
  /// the recorded stream.
  static constexpr Duration kLongestGap = std::chrono::seconds(5);
  /// Lateness after which playback continues later instead of at once (as Pacer::kLongestSkip).
  static constexpr Duration kLatest = std::chrono::seconds(1);

  /// The first frame is due at its recorded media time. `loop`: playback starts again at the end.
  RecordingPlayer(StreamReader reader, bool loop);

  /// Reads the next item, unless it was read already. `now`: media time. Returns the time at which
  /// the item is due; nullopt at the end.
  [[nodiscard]] std::optional<MediaTime> prepare(MediaTime now);
  /// Returns the prepared item with its media time, id and epoch for viewers. Requires that
  /// prepare() has returned a time since the last call.
  [[nodiscard]] RecordedItem take();

  /// Continues with the first frame at `time_s` seconds after the begin of the recording.
  void seek(double time_s);
  /// Sets the speed, limits::kLeastSpeed..kMostSpeed recorded seconds a second.
  void setSpeed(double speed);
  /// Continues after a time without playback.
  void resume() { is_continuous_ = is_planned_ = false; }

  [[nodiscard]] const StreamReader& reader() const { return reader_; }
  [[nodiscard]] double speed() const { return speed_; }

 private:
  /// What the last frame was in the recording, and for viewers.
  struct Last {
    MediaTime recorded;
    MediaTime time;
    std::uint64_t id;
    std::uint32_t epoch;
  };
  [[nodiscard]] std::optional<RecordedItem> read();
  /// Plans when the prepared frame is due, and its ids.
  void plan(const CodedFrame& frame, MediaTime now);
  void change(CodedFrame& frame) const;
  /// Returns when a recorded time is played.
  [[nodiscard]] MediaTime toPlayed(MediaTime recorded) const;

  StreamReader reader_;
  bool loop_;
  double speed_ = 1.0;
  std::optional<RecordedItem> item_;  // prepared
  MediaTime due_{};                   // of item_
  std::optional<Last> last_;
  bool is_planned_ = false;     // due_ is that of item_, a frame
  bool is_continuous_ = false;  // the next frame follows the last one
  MediaTime origin_{};          // recorded time that is played at start_
  MediaTime start_{};
  // The recorded id of the first frame after the discontinuity, and its id for viewers.
  std::uint64_t recorded_first_id_ = 0, first_id_ = 0;
  std::uint32_t epoch_shift_ = 0;
};

}  // namespace hapticast::server
