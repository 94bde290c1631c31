// SPDX-License-Identifier: MIT
// Interface of a view. A view shows or stores a run for the user: screenshot, film, window, sound.
// To add a kind of view, add a file in this folder and a line in openViews()
// (client/desk/user_interface.cpp).
// Thread: each function states its own.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "client/view/study_prompt.hpp"
#include "common/haptic_frame.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// State of the connection for the views. The struct owns no memory.
struct ConnectionStats {
  bool connected = false;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  std::uint64_t slices_lost = 0;
  double scan_share = 1.0;       ///< scanned share of the server's clip, 0..1; 1: no scan
  bool picture_reduced = false;  ///< the link carries fewer pictures than the stream has
  double clock_error_us = 0.0;   ///< largest error of the media clock; 0: unknown
  double fps = 25.0;             ///< frames per second that the server announced
  std::optional<Timeline> timeline = std::nullopt;  ///< present: the user may seek

  /// Returns true if the server scans its clip, so that no frames arrive yet.
  [[nodiscard]] bool isScanning() const { return connected && scan_share < 1.0; }
};

/// Place and speed of a recording that the user wants.
struct TimelineRequest {
  std::optional<double> seek_s;  ///< place in the recording, s
  std::optional<double> speed;   ///< limits::kLeastSpeed..kMostSpeed
  bool operator==(const TimelineRequest&) const = default;
};

/// State that the client and its views share.
struct UiState {
  UserControls user;               ///< controls of the user; a view may change them
  PointerTarget pointer;           ///< only the view whose points() is true writes it
  bool pointer_is_device = false;  ///< true: the pointer moves the HIP (mouse)
  ConnectionStats stream;          ///< state of the connection; views only read it
  TimelineRequest timeline;        ///< a view sets it; the client sends and removes it
  bool record = false;             ///< a view sets it; while true, the client logs into a new file
  /// What the user has to confirm with Enter, or what the client does meanwhile; empty: nothing.
  std::string request;
  bool confirmed = false;  ///< a view sets it if the user presses Enter
  std::string recording;   ///< name of that log file, or an error; empty before the first one
  std::optional<StudyPrompt> study;  ///< present: the client runs a study
  StudyInput study_input;            ///< a view sets it
  Duration picture_ahead{0};         ///< of a study: how much earlier than the force it comes
  std::uint32_t beeps = 0;           ///< a new value: a view with sound plays a beep
};

/// Interface of a view of a run.
class View {
 public:
  virtual ~View() = default;

  /// Receives a picture of the stream and its `workspace`. Thread: any.
  virtual void onPicture(VideoFrame picture, const Workspace& workspace) = 0;
  /// Receives the reliefs of the next frame. Thread: network.
  virtual void onFrame(const PlayableReliefs& /*frame*/) {}
  /// Receives the report of a tick. Its `time` counts from the first tick of the run. The reports
  /// arrive in order and soon after their ticks. Thread: main.
  virtual void onReport(const TickReport& report) = 0;
  /// Runs the view's part of the main loop. The client calls it about every 10 ms. It must not
  /// block. Returns false if the user ends the run in this view. Thread: main.
  [[nodiscard]] virtual bool update(UiState& ui_state) = 0;
  /// Ends the view after the last tick, and writes its file. Throws std::runtime_error with one
  /// line: flag and file. Thread: main.
  virtual void finish() = 0;
  /// Returns true if the view needs the stream's pictures. Without such a view the client requests
  /// none.
  [[nodiscard]] virtual bool wantsVideo() const { return true; }
  /// Returns true if much waits for the view's own thread. A replay then waits. Thread: main.
  [[nodiscard]] virtual bool isBusy() { return false; }
  /// Returns true if the user can move the pointer over the view, so that a mouse can be a device.
  [[nodiscard]] virtual bool points() const { return false; }
  /// Returns a histogram of the difference in play time between the shown picture and the rendered
  /// frame, ns. It has one entry per drawing. Returns null for a view without a live picture.
  /// Thread: main.
  [[nodiscard]] virtual const Histogram* eyeHand() const { return nullptr; }
};

using Views = std::vector<std::unique_ptr<View>>;

}  // namespace hapticast::client
