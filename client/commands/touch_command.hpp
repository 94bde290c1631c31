// SPDX-License-Identifier: MIT
// The client: it creates all parts and connects them. The haptic loop, the network and the decoding
// of frames have a thread each. The thread that calls run() has the event loop: it processes log
// lines, faults, views and the contact flag.
#pragma once

#include <memory>

#include "client/settings/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

class App {
 public:
  /// Opens the device. During run(), `views` receive the pictures and the reports. Throws
  /// std::runtime_error (one line) if the device cannot be opened or a setting is invalid.
  App(Settings settings, const Clock& clock, Views views);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Runs the client. If no server answers, the client retries. The run ends when --seconds are
  /// over, when a signal arrives (SIGINT, SIGTERM, SIGHUP), or when the user ends it in a view. It
  /// also ends after stop(), and when the server cannot be used.
  ///
  /// Returns false if no server was connected within --seconds, or if the server cannot be used.
  /// The log then has the reason. Throws std::runtime_error if a file cannot be written.
  bool run();
  /// Ends run() soon. Thread: any.
  void stop() noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::client
