// SPDX-License-Identifier: MIT
// The client as wiring: the loop on its own thread, the network on another; the calling thread
// writes the log, keeps the picture and waits for the end.
#pragma once

#include <atomic>
#include <fstream>
#include <memory>
#include <string>

#include "client/device/virtual_device.hpp"
#include "client/haptics/loop.hpp"
#include "client/haptics/room.hpp"
#include "client/net/connection.hpp"
#include "client/net/receiver.hpp"
#include "client/settings.hpp"
#include "client/summary.hpp"
#include "client/view/view.hpp"
#include "common/wire/asio.hpp"

namespace hapticast::client {

class App {
 public:
  /// Loads profile and hand script; `views` are shown what happens. Throws std::runtime_error, one
  /// line.
  App(Settings settings, const Clock& clock, Views views);

  /// Touches until --seconds are over, Ctrl-C, a view wants to end, or stop(). Returns false when
  /// the server could never be reached or speaks another protocol (said in the log). Throws
  /// std::runtime_error when a file cannot be written.
  bool run();
  /// Thread: any.
  void stop() noexcept { stop_ = true; }

 private:
  void wait();
  void drain();
  void dumpFault();
  void show(VideoFrame picture);
  void sayOnce(const std::string& why);
  [[nodiscard]] RunResult result() const;
  void finish();

  Settings settings_;
  const Clock& clock_;
  RoomSettings room_settings_;
  HandScript hand_;
  VirtualDevice device_;
  FramePool pool_;
  LatestValue<StreamState> stream_;
  LatestValue<UserControls> user_controls_;
  UserControls user_;
  LatestValue<TickReport> latest_report_;
  Room::Log log_ring_;
  std::unique_ptr<Room> room_;  // large: holds the flight recorder
  LoopStats stats_;
  RealtimeGrant realtime_;
  asio::io_context io_;
  Receiver receiver_;
  Connection connection_;
  std::ofstream log_;
  Views views_;
  std::atomic<bool> stop_{false};
  std::atomic<bool> failed_{false};
  int faults_dumped_ = 0;
  bool told_contact_ = false;
  std::string told_why_;  // the connection is down for this reason; network thread
};

}  // namespace hapticast::client
