// SPDX-License-Identifier: MIT
// Plays a recorded stream in real time, without vision. The first pass has the recorded media
// times, ids and epochs. After each discontinuity (a loop, a seek, a pause, another speed, a gap, a
// machine that stood still) the stream continues in a new epoch: media times and ids count on, and
// the reliefs count as new. At another speed s, velocities are multiplied by s, accelerations by
// s^2. Callers pass all times as arguments: the class has no thread and no clock. Thread: one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "common/playback/stream_reader.hpp"
#include "common/time.hpp"

namespace hapticast {

/// Returns the description of a stream that plays `recorded` at `speed`. `name`: of the stream;
/// empty: as recorded.
[[nodiscard]] StreamDescription describePlayback(const StreamDescription& recorded, double speed,
                                                 const std::string& name);

/// The playback of one recording for one stream.
class RecordingPlayer {
 public:
  /// Playback skips a longer pause between two recorded frames. Chosen: an operator paused the
  /// recorded stream.
  static constexpr Duration kLongestGap = std::chrono::seconds(5);
  /// Lateness after which playback continues later instead of at once (as Pacer::kLongestSkip).
  static constexpr Duration kLatest = std::chrono::seconds(1);

  /// The first frame is due at its recorded media time, if playback begins within kLatest of it;
  /// otherwise at once. `loop`: playback starts again at the end.
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

  /// Returns the recording.
  [[nodiscard]] const StreamReader& reader() const { return reader_; }
  /// Returns why playback met the end of the recording early, as a phrase, and how much it has
  /// played until then; empty: it has not.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] Duration played() const { return played_; }
  /// Returns whether the prepared item is a frame.
  [[nodiscard]] bool hasFrame() const {
    return item_ && std::holds_alternative<CodedFrame>(*item_);
  }
  /// Returns the present speed.
  [[nodiscard]] double speed() const { return speed_; }
  /// Returns the place of playback at its present speed, from the frame that was prepared last.
  [[nodiscard]] Timeline timeline() const;

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
  std::string problem_;
  Duration played_{0};
  bool is_planned_ = false;     // due_ is that of item_, a frame
  bool is_continuous_ = false;  // the next frame follows the last one
  MediaTime origin_{};          // recorded time that is played at start_
  MediaTime start_{};
  // The recorded id of the first frame after the discontinuity, and its id for viewers.
  std::uint64_t recorded_first_id_ = 0, first_id_ = 0;
  std::uint32_t epoch_shift_ = 0;
};

}  // namespace hapticast
