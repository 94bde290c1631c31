// SPDX-License-Identifier: MIT
// The server as a whole: creates all its parts and connects them. Source and vision run on the
// calling thread, the encoding on a second thread (EncoderThread), and the network on a third.
#pragma once

#include <memory>

#include "common/time.hpp"
#include "server/settings/settings.hpp"
#include "server/show/reload.hpp"

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

  /// Streams until the clip ends (with --loop the clip repeats), until the number of frames in
  /// --frames is reached, or until stop(). Throws SourceError if the source fails during the
  /// streaming. Call it once. Thread: the pipeline's.
  void run();
  /// Ends run() soon. Thread: any, also a signal handler.
  void stop() noexcept;
  /// Returns whether streaming has begun. A later failure of run() is not due to wrong input of the
  /// user.
  [[nodiscard]] bool streaming() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
