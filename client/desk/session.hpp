// SPDX-License-Identifier: MIT
// The session with one server. It finds and dials the server, receives and decodes its stream, and
// logs the events of the connection. It owns the network thread and the decode thread.
// Thread: that of connect(), except where a function states another one.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "client/desk/desk.hpp"
#include "client/report/summary.hpp"
#include "client/settings/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class Session {
 public:
  /// Prepares a session whose stream goes to the device, the views and the recording of `desk`,
  /// which must outlive the session. If the server cannot be used, the session ends the run
  /// (Desk::stop()). `before`: findEnd() of the session or stream before this one. Throws
  /// std::runtime_error (one line) if a file of `settings` cannot be used.
  Session(const Settings& settings, Desk& desk, const StreamTiming& before = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts the threads, and the search for the server.
  void connect();
  /// Requests another pause, place or speed of this viewer's stream, where it has a time line.
  void control(const Control& control);
  /// Ends the connection and joins the threads.
  void stop();
  /// Returns the newest statistics of the connection. Thread: one.
  [[nodiscard]] const ConnectionStats& stats();
  /// Sets the contact flag of the reports to the server. It is true if the HIP is in contact.
  void setInContact(bool contact);
  /// Returns a text with the servers on the LAN, for the log. It does so only while three
  /// conditions hold: the user named no server, no server answers, and the list has changed.
  /// Otherwise returns nullopt.
  std::optional<std::string> listServers(LocalTime now);
  /// Returns the name of the server (nameServer()).
  [[nodiscard]] std::string serverName() const;
  /// Returns true if the session has ended with an error after which no retry follows. Thread: any.
  [[nodiscard]] bool failed() const;
  /// Returns the reason why no server was ever connected. Returns nullopt if one was connected.
  /// Call it after stop().
  [[nodiscard]] std::optional<std::string> neverConnected() const;
  /// Returns the timing with which another session continues. Call it after stop().
  [[nodiscard]] StreamTiming findEnd() const;
  /// Writes the counters of the session to `result`. Call it after stop().
  void addTo(RunResult& result) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::client
