// SPDX-License-Identifier: MIT
// Plays the trials of a study at a desk: prompts, the stream of each trial, and interruptions. The
// loop of the desk runs from the first prompt to the end, so that the force of one trial fades out
// before the next condition begins. The thread of the owner has the event loop: every function that
// waits runs turns of the desk meanwhile.
// Thread: main.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "client/desk/desk.hpp"
#include "client/desk/session.hpp"
#include "client/study/motion_file.hpp"
#include "client/study/study.hpp"
#include "client/study/study_folder.hpp"
#include "client/study_run/trial_stream.hpp"

namespace hapticast::client {

/// How a trial ended. All but kComplete leave it without a result. kEnded: the program has to end.
enum class TrialEnd : std::uint8_t {
  kComplete,
  kStopped,  ///< by Esc
  kDeviceLost,
  kStreamLost,
  kTrustLost,  ///< the safety chain has halted the force (safety/trust.hpp)
  kEnded,
};

class TrialPlayer {
 public:
  /// `settings` and `desk` must outlive this object.
  TrialPlayer(const Settings& settings, Desk& desk) : settings_(settings), desk_(desk) {}
  ~TrialPlayer() { finishStream(); }
  TrialPlayer(const TrialPlayer&) = delete;
  TrialPlayer& operator=(const TrialPlayer&) = delete;

  [[nodiscard]] Desk& desk() { return desk_; }
  /// Starts the haptic loop. Records to `recording` and to `motion`, which began at `begin`
  /// (nullopt: now). Returns that time. Throws std::runtime_error (one line).
  WallTime start(const std::filesystem::path& recording, MotionFile& motion,
                 std::optional<WallTime> begin);

  /// Shows `prompt` and waits for its answer. Returns nullopt if the subject stops the force, or if
  /// the program has to end.
  [[nodiscard]] std::optional<StudyInput> ask(const StudyPrompt& prompt);
  /// Waits for `seconds` without a force. Returns false if ask() would return nullopt.
  [[nodiscard]] bool wait(double seconds, const StudyPrompt& prompt = {});
  /// Lets the subject touch `condition`, whose streams start with `seed`. Returns after the
  /// interval when the force is zero, at the latest after 2 s.
  [[nodiscard]] TrialEnd play(const Condition& condition, std::uint64_t seed);
  /// Waits until the device answers, 10 s at most. Returns whether it does.
  [[nodiscard]] bool waitForDevice();
  /// Lets the force fade in again after a stop or a lost device.
  void rearm();
  /// Plays `count` beeps, one after the other, in the views with sound. Returns as wait().
  [[nodiscard]] bool beep(int count);

  /// Returns the time since the start of the motion file, and that of the last interval's onset.
  [[nodiscard]] double now_s() const;
  [[nodiscard]] double onset_s() const { return onset_s_; }
  [[nodiscard]] WallTime onsetWall() const { return onset_wall_; }
  /// Returns why no force can act, such as a lost device or a loss of trust; kComplete: it can.
  [[nodiscard]] TrialEnd findInterruption() const;
  /// Returns whether the program has to end: a signal, or the window is closed.
  [[nodiscard]] bool ended() const { return desk_.ended(); }
  /// Returns whether the subject has stopped the force since the last rearm().
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Forgets the stop, so that ask() waits again. The force remains zero until rearm().
  void clearStop() { stopped_ = false; }
  /// Returns whether the thermal limit has reduced the force since the last call.
  [[nodiscard]] bool takeWarm() { return std::exchange(warm_, false); }
  /// Ends the loop with the force at zero, and the stream. Returns the statistics of the loop.
  const LoopStats& finish();

 private:
  void turn();
  void onReport(TickReport& report);
  void startStream(const Condition& condition, std::uint64_t seed);
  void finishStream();
  [[nodiscard]] TrialEnd waitForFirstFrame();
  [[nodiscard]] TrialEnd findTrialEnd() const;
  [[nodiscard]] bool hasStream() const { return stream_ != nullptr || session_ != nullptr; }
  [[nodiscard]] bool isInterrupted() const { return ended() || stopped_; }
  void changeControls(const Condition& condition);

  const Settings& settings_;
  Desk& desk_;
  MotionFile* motion_ = nullptr;
  double offset_s_ = 0.0;
  LocalTime start_{};
  std::unique_ptr<TrialStream> stream_;  // of a recording
  std::unique_ptr<Session> session_;     // with a server
  StreamTiming last_timing_;
  double onset_s_ = 0.0;
  WallTime onset_wall_;
  bool has_frame_ = false;  // of the present stream
  bool device_lost_ = false;
  bool warm_ = false;
  bool stopped_ = false;
};

}  // namespace hapticast::client
