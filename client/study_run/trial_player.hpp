// SPDX-License-Identifier: MIT
// The desk of a subject during a study: device, haptic loop, window, recording and motion file. The
// loop runs from the first prompt to the end, so that the force of one trial fades out before the
// next condition begins. The thread of the owner has the event loop: every function that waits
// processes reports, views and signals meanwhile.
// Thread: main.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "client/desk/local_device.hpp"
#include "client/desk/run_recorder.hpp"
#include "client/desk/session.hpp"
#include "client/loop/loop.hpp"
#include "client/report/reporter.hpp"
#include "client/study/motion_file.hpp"
#include "client/study/study.hpp"
#include "client/study/study_folder.hpp"
#include "client/study_run/trial_stream.hpp"
#include "common/transport/asio.hpp"

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
  /// Opens the device and the views. Throws std::runtime_error (one line).
  TrialPlayer(const Settings& settings, const Clock& clock, Views views);
  ~TrialPlayer();
  TrialPlayer(const TrialPlayer&) = delete;
  TrialPlayer& operator=(const TrialPlayer&) = delete;

  [[nodiscard]] const DeviceProfile& profile() const { return profile_; }
  [[nodiscard]] std::string deviceName() const { return local_.device->description(); }
  /// Checks a device that was never checked. Returns false if the user ends the program meanwhile.
  [[nodiscard]] bool checkDevice();
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
  /// Returns whether the device was detected automatically, and is no simulation.
  [[nodiscard]] bool isAutoDetected() const { return local_.is_auto_detected; }
  /// Returns the number of ticks that are missing in the results. Call it after finish().
  [[nodiscard]] std::uint64_t droppedTicks() const { return local_.renderer->droppedReports(); }
  /// Returns whether the program has to end: a signal, or the window is closed.
  [[nodiscard]] bool ended() const { return ended_; }
  /// Returns whether the subject has stopped the force since the last rearm().
  [[nodiscard]] bool stopped() const { return stopped_; }
  /// Forgets the stop, so that ask() waits again. The force remains zero until rearm().
  void clearStop() { stopped_ = false; }
  /// Returns whether the thermal limit has reduced the force since the last call.
  [[nodiscard]] bool takeWarm() { return std::exchange(warm_, false); }
  /// Ends the loop with the force at zero. Returns its statistics.
  const LoopStats& finish();

 private:
  void turn();
  void onReport(TickReport report);
  void startStream(const Condition& condition, std::uint64_t seed);
  void finishStream();
  [[nodiscard]] TrialEnd waitForFirstFrame();
  [[nodiscard]] TrialEnd findTrialEnd() const;
  [[nodiscard]] bool hasStream() const { return stream_ != nullptr || session_ != nullptr; }
  [[nodiscard]] bool isInterrupted() const { return ended_ || stopped_; }
  void changeControls(const Condition& condition);

  const Settings& settings_;
  const Clock& clock_;
  asio::io_context io_;  // signals
  asio::signal_set signals_{io_, SIGINT, SIGTERM};
  UserInterface ui_;
  LocalDevice local_;
  DeviceProfile profile_;
  Reporter reporter_;
  std::unique_ptr<RunRecorder> recorder_;
  MotionFile* motion_ = nullptr;
  double offset_s_ = 0.0;
  LocalTime start_{};
  std::unique_ptr<TrialStream> stream_;  // of a recording
  std::unique_ptr<Session> session_;     // with a server
  Settings session_settings_;            // of session_
  StreamTiming last_timing_;
  std::unique_ptr<LoopThread> loop_;
  TickReport last_report_;
  double onset_s_ = 0.0;
  WallTime onset_wall_;
  bool has_frame_ = false;  // of the present stream
  bool device_lost_ = false;
  bool warm_ = false;
  bool stopped_ = false;
  std::atomic<bool> ended_{false};
};

}  // namespace hapticast::client
