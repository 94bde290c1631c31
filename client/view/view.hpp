// SPDX-License-Identifier: MIT
// What the app's event loop asks of any view: a screenshot, a film, a window. A further kind is one
// file beside this one and one line in client/open_views.cpp.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "client/haptics/pointer.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/haptics/user_controls.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// What is known of the network. A plain value that owns nothing.
struct StreamStatus {
  bool connected = false;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  std::uint64_t slices_lost = 0;
  double clock_error_us = 0.0;  ///< bound of the error of the media clock; 0: not known
};

/// What lies between the app and its views.
struct Desk {
  UserControls user;      ///< a view may change it
  PointerTarget pointer;  ///< the one that points() writes it
  StreamStatus stream;    ///< to be looked at
};

class View {
 public:
  virtual ~View() = default;

  /// Takes a picture of the stream, which belongs to `workspace`. Thread: any.
  virtual void takePicture(VideoFrame picture, const Workspace& workspace) = 0;
  /// Takes the report of a tick, whose `time` counts from the first tick of the run. The ticks
  /// come in order and shortly after they happened.
  /// Thread: main.
  virtual void takeReport(const TickReport& report) = 0;
  /// The view's share of a turn of the event loop, about every 10 ms; it must not wait. Returns
  /// false when the user wants to end. Thread: main.
  [[nodiscard]] virtual bool turn(Desk& desk) = 0;
  /// Ends the view after the last tick: what it was asked to write is written. Throws
  /// std::runtime_error, one line that names the flag and the file. Thread: main.
  virtual void finish() = 0;
  /// Whether somebody can point at something in it, so that a mouse can be a device.
  [[nodiscard]] virtual bool points() const { return false; }
};

using Views = std::vector<std::unique_ptr<View>>;

}  // namespace hapticast::client
