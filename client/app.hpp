// SPDX-License-Identifier: MIT
// The client as wiring: loop, network and preparation have a thread each; the calling thread runs
// the event loop of log, faults, views and the flag of contact.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "client/chosen_device.hpp"
#include "client/connection_teller.hpp"
#include "client/device_buttons.hpp"
#include "client/fault_files.hpp"
#include "client/haptics/loop_thread.hpp"
#include "client/haptics/room.hpp"
#include "client/log.hpp"
#include "client/net/connection.hpp"
#include "client/net/receiver.hpp"
#include "client/rearm.hpp"
#include "client/server_choice.hpp"
#include "client/settings.hpp"
#include "client/summary.hpp"
#include "client/touch_teller.hpp"
#include "client/view/view.hpp"
#include "common/wire/asio.hpp"

namespace hapticast::client {

class App {
 public:
  /// Opens the device; `views` are shown what happens. Throws std::runtime_error, one line.
  App(Settings settings, const Clock& clock, Views views);

  /// Touches until --seconds are over, a signal (SIGINT, SIGTERM, SIGHUP), a view wants to end, or
  /// stop(); waits for a server that is not there. Returns false when none came in --seconds, or
  /// when there can be none (said in the log). Throws std::runtime_error when a file cannot be
  /// written.
  bool run();
  /// Thread: any.
  void stop() noexcept { stop_ = true; }

 private:
  [[nodiscard]] ConnectionEvents connectionEvents();
  // On the network's thread:
  void show(const VideoFrame& picture);
  void prepared(const PreparedFrame& frame);
  void tellStatus(bool connected);
  // On the calling thread:
  void runEvents();
  bool turnViews();
  void record();
  void takeReports();
  void takeFaults();
  void takeButtons();
  void tellContact();
  [[nodiscard]] RunResult result(const LoopThread& loop) const;
  void finish(const LoopThread& loop);

  Settings settings_;
  const Clock& clock_;
  LatestValue<TickReport> published_;  // the device's hand reads it
  LatestValue<PointerTarget> pointer_;
  Views views_;
  ChosenDevice device_;
  RoomSettings room_settings_;
  FramePool pool_;
  LatestValue<StreamState> stream_;
  LatestValue<UserControls> user_controls_;
  LatestValue<StreamStatus> stream_status_;  // the network's thread writes it
  Desk desk_;                                // main thread
  Room::Log log_ring_;
  std::unique_ptr<Room> room_;  // large: holds the flight recorder
  asio::io_context io_;
  Preparer preparer_;
  Receiver receiver_;
  ServerChoice choice_;
  Connection connection_;
  LogFile log_;
  std::optional<LogFile> recording_;  // asked for by a view
  FaultFiles fault_files_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> failed_{false};
  std::optional<LocalTime> begin_;  // of the first tick
  TickReport last_report_;          // of those taken from log_ring_; its time counts from begin_
  bool told_contact_ = false;
  Rearm rearm_;
  DeviceButtons buttons_;
  TouchTeller touch_teller_;
  bool time_is_over_ = false;
  OddityTeller oddities_;    // network thread
  ConnectionTeller teller_;  // network thread; after it has ended the calling one
};

}  // namespace hapticast::client
