// SPDX-License-Identifier: MIT
// The server as a whole: creates all its parts and connects them. Source and vision run on the
// calling thread, the encoding on a second thread (EncoderThread), and the network on a third.
#pragma once

#include <memory>

#include "common/time.hpp"
#include "server/reload.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// One server with its source and its viewers.
class App {
 public:
  /// Opens the source and the port. Throws SourceError, AddressError or std::runtime_error; each
  /// message has one line. `clock` must outlive App. `reread`: reads the settings again at SIGHUP;
  /// null: SIGHUP changes nothing.
  App(Settings settings, const Clock& clock, ReadSettings reread = nullptr);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Streams until the clip ends, unless --loop repeats it. It also ends after as many frames as
  /// --frames states, or after stop(). Throws SourceError if the source fails during the streaming.
  /// Call it once. Thread: the pipeline's.
  void run();
  /// Ends run() soon. Thread: any, also a signal handler.
  void stop() noexcept;
  /// Returns whether streaming has begun. If run() fails after that, the cause is not a wrong input
  /// of the user.
  [[nodiscard]] bool streaming() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
