// SPDX-License-Identifier: MIT
// Interface of a view: screenshot, film, window, sound. A further kind needs one file beside this
// one and one line in client/open_views.cpp.
// Thread: each function states its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/haptic_frame.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// State of the connection for views, without ownership.
struct ConnectionStats {
  bool connected = false;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  std::uint64_t slices_lost = 0;
  double clock_error_us = 0.0;  ///< error bound of the media clock; 0: unknown
  double fps = 25.0;            ///< announced rate
};

/// State that the app and its views share.
struct UiState {
  UserControls user;       ///< a view may change it
  PointerTarget pointer;   ///< written by the view with points()
  ConnectionStats stream;  ///< read-only for views
  bool record = false;     ///< request of a view: log into a new file while set
  std::string recording;   ///< read-only for views: the log file, or an error; empty before
};

/// A view of a run.
class View {
 public:
  virtual ~View() = default;

  /// Receives a picture of the stream with its `workspace`. Thread: any.
  virtual void onPicture(VideoFrame picture, const Workspace& workspace) = 0;
  /// Receives the reliefs of the next frame. Thread: network.
  virtual void onFrame(const PlayableReliefs& /*frame*/) {}
  /// Receives the report of a tick; its `time` counts from the first tick of the run. Ticks arrive
  /// in order and soon. Thread: main.
  virtual void onReport(const TickReport& report) = 0;
  /// Runs the view's share of the main loop, about every 10 ms. Must not block. Returns false if
  /// the user ends the run. Thread: main.
  [[nodiscard]] virtual bool update(UiState& ui_state) = 0;
  /// Ends the view after the last tick and writes its files. Throws std::runtime_error with one
  /// line: flag and file. Thread: main.
  virtual void finish() = 0;
  /// Returns true if the view needs the stream's pictures.
  [[nodiscard]] virtual bool wantsVideo() const { return true; }
  /// Returns true if the user can point into the view, so that a mouse can be a device.
  [[nodiscard]] virtual bool points() const { return false; }
  /// Distribution of the difference in play time between shown picture and rendered frame, one
  /// entry per drawing. Null for a view without a live picture. Thread: main.
  [[nodiscard]] virtual const Histogram* eyeHand() const { return nullptr; }
};

using Views = std::vector<std::unique_ptr<View>>;

}  // namespace hapticast::client
