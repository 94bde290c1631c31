// SPDX-License-Identifier: MIT
// The client: it creates all parts and connects them. The loop, the network and the preparation of
// frames have a thread each. The thread that calls run() processes the events: log lines, faults,
// views and the contact flag.
#pragma once

#include <memory>

#include "client/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class App {
 public:
  /// Opens the device. From run() on, `views` receive the pictures and the reports. Throws
  /// std::runtime_error (one line).
  App(Settings settings, const Clock& clock, Views views);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Runs the client, and waits for a server if none answers. It ends in four cases: --seconds are
  /// over, a signal arrives (SIGINT, SIGTERM, SIGHUP), the user ends it in a view, or stop() is
  /// called. Returns false if no server was connected within --seconds. Returns false as well if
  /// the server cannot be used; the log then has the reason. Throws std::runtime_error if a file
  /// cannot be written.
  bool run();
  /// Ends run() soon. Thread: any.
  void stop() noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::client
