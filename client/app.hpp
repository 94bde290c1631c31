// SPDX-License-Identifier: MIT
// The client as wiring: loop, network and preparation have a thread each; the calling thread runs
// the event loop of log, faults, views and the flag of contact.
#pragma once

#include <memory>

#include "client/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class App {
 public:
  /// Opens the device; `views` are shown what happens. Throws std::runtime_error, one line.
  App(Settings settings, const Clock& clock, Views views);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Touches until --seconds are over, a signal (SIGINT, SIGTERM, SIGHUP), a view wants to end, or
  /// stop(); waits for a server that is not there. Returns false when none came in --seconds, or
  /// when there can be none (said in the log). Throws std::runtime_error when a file cannot be
  /// written.
  bool run();
  /// Thread: any.
  void stop() noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::client
