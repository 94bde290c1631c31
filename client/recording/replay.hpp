// SPDX-License-Identifier: MIT
// Replay: renders a recorded run again. The renderer receives the same readings, frames,
// timing and controls at the same ticks, so that the result has the same bits. The recording's
// order is that of the network thread for the events of the stream, and that of the loop for the
// ticks. Before each tick, as many frames are handed over as the recorded loop had taken. With
// other settings the readings stay the same: the hand does not answer to the other force. Thread:
// one.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "client/net/frame_preparer.hpp"
#include "client/recording/recording_reader.hpp"
#include "common/result.hpp"

namespace hapticast::client {

/// Returns whether all components of both vectors have the same bits.
[[nodiscard]] bool hasSameBits(const Vec3& a, const Vec3& b);

/// Settings that replace the recorded ones, also those that the user chose during the run.
struct ReplayChanges {
  std::optional<Method> method;
  std::optional<SurfaceKind> surface;
  std::optional<double> stiffness_N_mm;  ///< of all surfaces
  std::optional<double> stiffness_limit_N_mm;

  [[nodiscard]] bool any() const {
    return method || surface || stiffness_N_mm || stiffness_limit_N_mm;
  }
};

/// Result of a replay.
struct ReplayCounts {
  std::uint64_t ticks = 0;
  std::uint64_t different = 0;  ///< ticks whose force has other bits than the recorded one
  double largest_difference_N = 0.0;

  /// Counts a tick with these forces.
  void add(const Vec3& force_N, const Vec3& recorded_N);
};

/// Receivers of what a replay reads and renders; each may be empty.
struct ReplayOutputs {
  std::function<void(const TickReport&)> onTick = {};
  /// Receives each other message of the recording before the ticks that need it; settings and
  /// controls with the changes.
  std::function<void(RunChannel channel, std::uint64_t time_ns, std::span<const std::uint8_t> data)>
      onMessage = {};
  /// True: the replay ends after the present tick. Null: it does not end early.
  const std::atomic<bool>* stop = nullptr;
};

/// A recorded run.
class Replay {
 public:
  /// Opens `file`. Returns an error without the file's name if it is no recording of a client.
  /// Calls `progress` as McapReader::open() does.
  [[nodiscard]] static Result<std::unique_ptr<Replay>> open(const std::string& file,
                                                            const ReadProgress& progress = {});

  /// Renders all ticks with `changes`. Call it once.
  ReplayCounts run(const ReplayChanges& changes, const ReplayOutputs& outputs);
  /// Returns why the ticks end before the end of the file, as a phrase; empty: they do not.
  [[nodiscard]] const std::string& problem() const { return file_.problem(); }

 private:
  /// An event of the stream: a frame, or a reset of the reliefs.
  using StreamEvent = std::variant<AssembledFrame, Workspace>;

  explicit Replay(TypedReader<RecordedContent> file) : file_(std::move(file)) {}
  /// Reads a message. Returns false at the end, or at the first damage.
  bool readMessage();
  void add(RendererSettings settings);
  void add(std::vector<TickReport> ticks);
  void add(AssembledFrame frame);
  void add(RecordedPreparation preparation) {
    preparations_.push_back(preparation);
    known_frames_ += preparation.handed_over ? 1 : 0;
  }
  void add(const RecordedTiming& timing);
  void add(UserControls controls);
  void add(const StreamDescription&) {}  // it goes to the outputs only, as pictures do
  void add(const VideoFrame&) {}
  /// Replaces the recorded settings by those of the user.
  void change(RendererSettings& settings) const;
  /// Reads on until all inputs of `tick` are known. Returns false if they are missing.
  bool readInputsOf(const TickReport& tick);
  [[nodiscard]] bool hasInputsOf(const TickReport& tick) const;
  /// Prepares the frame of the next preparation, and hands it over if the recorded one was.
  bool prepareNext();
  [[nodiscard]] std::optional<std::size_t> findFrame(std::uint64_t id) const;

  TypedReader<RecordedContent> file_;
  ReplayOutputs outputs_;
  RendererSettings settings_;
  bool has_settings_ = false;
  ReplayChanges changes_;
  std::deque<TickReport> ticks_;
  std::deque<StreamEvent> events_;
  std::deque<RecordedPreparation> preparations_;
  std::map<std::uint64_t, StreamTiming> timings_;
  Workspace workspace_;  // of the newest timing
  std::map<std::uint64_t, UserControls> controls_;
  UserControls newest_controls_;
  std::uint64_t known_frames_ = 0;  // of all preparations so far that were handed over
  std::uint64_t handed_over_ = 0;
  std::size_t ahead_bytes_ = 0;  // read since the last tick had its inputs
  std::uint64_t last_tick_ = 0;

  SetClock clock_;  // stands: no force needs it
  FramePool pool_;
  FrameQueue queue_;
  std::optional<FramePreparer> preparer_;
};

}  // namespace hapticast::client
