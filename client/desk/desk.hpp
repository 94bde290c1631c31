// SPDX-License-Identifier: MIT
// The desk of a run with a person: device, haptic loop, views, log, recording and signals. Touch
// and study use it, so a fault has the same effect in both. The owner has the event loop, and calls
// turn() in it.
// Thread: main, except where a function states another one.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>

#include "client/desk/local_device.hpp"
#include "client/desk/run_recorder.hpp"
#include "client/desk/user_interface.hpp"
#include "client/device/loop/loop.hpp"
#include "client/report/reporter.hpp"

namespace hapticast::client {

class Desk {
 public:
  /// Opens the device, and the files of the log. From then on a signal ends the run, not the
  /// program (stopAtSignals()). Throws std::runtime_error (one line) if the device or a file cannot
  /// be opened. `settings` and `clock` must outlive this object.
  Desk(const Settings& settings, const Clock& clock, Views views);

  /// Checks a device that was never checked. Returns false if the run has to end. Throws like
  /// runFirstCheck().
  [[nodiscard]] bool checkDevice();
  /// Opens the recording and the port of `outputs`, if it has one. Throws like MessageOutputs.
  void openRecorder(const OutputSettings& outputs);
  /// Sets a function that receives the report of each tick, recorded but not yet logged and shown.
  /// It may change the report.
  void onReport(std::function<void(TickReport&)> on_report) { on_report_ = std::move(on_report); }
  /// Starts the haptic loop.
  void startLoop();
  /// Runs a turn of the event loop, about 10 ms: signals, reports, fault files, device and views.
  /// `stats` is the state of the connection.
  void turn(const ConnectionStats& stats);
  /// Makes ended() true. Thread: any.
  void stop() noexcept { stop_ = true; }
  /// Returns whether the run has to end: after a signal, the end of a view or stop(). Thread: any.
  [[nodiscard]] bool ended() const { return stop_ || signalled_; }
  /// Ends the loop with the force at zero, and processes its last reports. Requires startLoop().
  /// Returns its statistics.
  const LoopStats& stopLoop();
  /// Completes all files of the run, and writes the counters of the desk to `run`. Returns false if
  /// a file is not complete; the log has a line for each. Requires stopLoop(), and that no thread
  /// passes anything to ui() or recorder() any more.
  [[nodiscard]] bool finish(RunResult& run);

  [[nodiscard]] const Clock& clock() const { return clock_; }
  [[nodiscard]] UserInterface& ui() { return ui_; }
  [[nodiscard]] LocalDevice& local() { return local_; }
  /// Returns null without a recording.
  [[nodiscard]] RunRecorder* recorder() { return recorder_.get(); }
  /// Returns the newest report, as the loop made it.
  [[nodiscard]] const TickReport& lastReport() const { return last_report_; }

 private:
  /// Processes reports, faults and the device.
  void processReports();
  /// Runs the part of signals and views in a turn.
  void updateViews(const ConnectionStats& stats);

  const Settings& settings_;
  const Clock& clock_;
  UserInterface ui_;
  LocalDevice local_;
  const std::atomic<bool>& signalled_;  // after local_: a signal ends a device that opens for long
  Reporter reporter_;
  std::atomic<bool> stop_{false};
  std::function<void(TickReport&)> on_report_;
  std::unique_ptr<RunRecorder> recorder_;  // null: no recording
  TickReport last_report_;
  std::optional<LoopThread> loop_;  // last: it uses everything above
};

}  // namespace hapticast::client
