// SPDX-License-Identifier: MIT
// What the app's event loop asks of any view: a screenshot, a film, a window, a sound. A further
// kind is one file beside this one and one line in client/user_interface.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client/haptics/playback/playable_reliefs.hpp"
#include "client/haptics/pointer.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/haptic_frame.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// What is known of the network. A plain value that owns nothing.
struct ConnectionStats {
  bool connected = false;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  std::uint64_t slices_lost = 0;
  double clock_error_us = 0.0;  ///< bound of the error of the media clock; 0: not known
  double fps = 25.0;            ///< as announced
};

/// What lies between the app and its views.
struct UiState {
  UserControls user;       ///< a view may change it
  PointerTarget pointer;   ///< the one that points() writes it
  ConnectionStats stream;  ///< to be looked at
  bool record = false;     ///< a view asks for a log in a new file, as long as it is set
  std::string recording;   ///< to be looked at: the file, or why there is none; empty before
};

class View {
 public:
  virtual ~View() = default;

  /// Takes a picture of the stream, which belongs to `workspace`. Thread: any.
  virtual void onPicture(VideoFrame picture, const Workspace& workspace) = 0;
  /// Takes what can be felt of the next frame. Thread: network.
  virtual void onFrame(const PlayableReliefs& /*frame*/) {}
  /// Takes the report of a tick, whose `time` counts from the first tick of the run. The ticks
  /// come in order and shortly after they happened.
  /// Thread: main.
  virtual void onReport(const TickReport& report) = 0;
  /// The view's share of a turn of the event loop, about every 10 ms; it must not wait. Returns
  /// false when the user wants to end. Thread: main.
  [[nodiscard]] virtual bool update(UiState& ui_state) = 0;
  /// Ends the view after the last tick: what it was asked to write is written. Throws
  /// std::runtime_error, one line that names the flag and the file. Thread: main.
  virtual void finish() = 0;
  /// Whether it shows the stream's pictures, so that they have to be sent.
  [[nodiscard]] virtual bool wantsVideo() const { return true; }
  /// Whether somebody can point at something in it, so that a mouse can be a device.
  [[nodiscard]] virtual bool points() const { return false; }
  /// How far apart in play time the picture that was shown and the frame that was felt were, each
  /// time that it was drawn; null: it shows nothing while it runs. Thread: main.
  [[nodiscard]] virtual const Histogram* eyeHand() const { return nullptr; }
};

using Views = std::vector<std::unique_ptr<View>>;

}  // namespace hapticast::client
