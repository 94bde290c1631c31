// SPDX-License-Identifier: MIT
// The client of a web page, without sockets, threads and clocks: it receives the messages of a
// server, renders a tick for each millisecond, and returns messages for the server. A simulated
// light hand follows the pointer, as with --device mouse. The page passes all times.
// Thread: one, the worker of the page.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "client/device/pointed_hand.hpp"
#include "client/haptics/renderer.hpp"
#include "client/net/client_session.hpp"
#include "client/net/inline_preparation.hpp"
#include "client/view/status.hpp"

namespace hapticast::client {

/// A viewer of a stream. The object needs about 1 MB, so do not place it on the stack.
class WebViewer {
 public:
  /// `origin` checks the server's key (#origin-key= of the link). `access_token`: empty, or the
  /// secret of #token=. `name`: for the server's log and for operators; empty: "web page".
  explicit WebViewer(OriginPin origin = {}, std::string access_token = "", std::string name = "");

  // Sessions with the server, one after the other (ClientSession).

  /// Begins a session over a connection with this protection. Returns false, with the reason in
  /// end(), if it may not be.
  [[nodiscard]] bool open(Protection protection, LocalTime now);
  /// Processes a message of the server. Returns the message (a frame without its objects, which the
  /// receiver has). Returns nullopt if the session has failed: end() has the reason; call close().
  [[nodiscard]] std::optional<Message> receive(std::span<const std::uint8_t> bytes, LocalTime now);
  /// Prepares the oldest received frame for the renderer. Returns false if none waits. Call it
  /// until then, with ticks between.
  bool prepareNext(LocalTime now);
  /// Returns the next message for the server that is due, or nullopt.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> poll(LocalTime now);
  /// Sends a request with the next poll().
  void request(const Control& control) { (void)session_.request(control); }
  /// Requests pictures with the next poll(), or none, for example while the page is hidden.
  void requestPictures(bool wanted) { session_.requestPictures(wanted); }
  /// Returns whether a time limit of the session has passed; end() has the reason.
  [[nodiscard]] bool expire(LocalTime now);
  /// Sets the reason why the connection has ended, in place of those above.
  void setEnd(SessionEnd end) { end_ = std::move(end); }
  [[nodiscard]] const SessionEnd& end() const { return end_; }
  /// Ends the session with the reason of end(). The force fades to zero. Returns the pause before
  /// the next session, or nullopt if no further one can succeed.
  std::optional<Duration> close(LocalTime now);

  // Ticks.

  /// Moves the target of the hand, nominal mm.
  void point(const Vec3& position_mm);
  void setControls(const UserControls& controls);
  /// Renders the tick at `now`, with the simulated hand.
  const TickReport& tick(LocalTime now);
  /// Renders the tick at `now` with a given position of the device, in the device frame.
  const TickReport& tickAt(LocalTime now, const Vec3& position_mm);

  // For the page.

  [[nodiscard]] const TickReport& report() const { return renderer_.report(); }
  [[nodiscard]] DeviceMapping mapping() const { return renderer_.report().mapping; }
  [[nodiscard]] const ReceiverCounts& counts() const { return receiver_.counts(); }
  /// Returns the reliefs of the frame that was prepared last.
  [[nodiscard]] const PlayableReliefs& reliefs() const { return reliefs_; }
  /// Returns the media time at `now`; 0 before the clocks are synchronised.
  [[nodiscard]] MediaTime mediaNow(LocalTime now) const;
  /// Return the lines for the user: state and remedy, a hint for a beginner, safety states.
  [[nodiscard]] std::string adviceLine() const { return statusLine(report(), ui_); }
  [[nodiscard]] std::string beginnersLine() const { return hintLine(ticks_, ui_); }
  [[nodiscard]] std::string stateLine() const;
  /// Returns for each tick since the last call: magnitudes of the force, of its static and of its
  /// dynamic part (N), and 1 in contact or 0.
  [[nodiscard]] std::vector<float> popHistory() { return std::exchange(history_, {}); }

 private:
  const TickReport& render(LocalTime now, const DeviceState& reading);

  SetClock clock_;
  RendererSettings settings_;
  FramePool pool_;
  LatestValue<StreamTiming> timing_;
  LatestValue<UserControls> user_;
  InlinePreparation preparation_;
  Receiver receiver_;
  ClientSession session_;
  SessionEnd end_;
  PlayableReliefs reliefs_;
  PointedHand hand_;
  std::optional<Vec3> target_mm_;  // nominal
  HapticRenderer renderer_;
  Vec3 force_N_ = Vec3::Zero();
  UiState ui_;
  TickStatus ticks_;
  std::vector<float> history_;
};

}  // namespace hapticast::client
