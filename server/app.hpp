// SPDX-License-Identifier: MIT
// The server as wiring: source -> vision on the calling thread, frames to bytes on a second one
// (EncoderThread), the network on a third.
#pragma once

#include <memory>

#include "common/time.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

class App {
 public:
  /// Opens the source and the port. Throws SourceError, AddressError or std::runtime_error, one
  /// line each. `clock` outlives the app.
  App(Settings settings, const Clock& clock);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Streams until the clip ends (without --loop), --frames are shown, or stop(). Throws
  /// SourceError when the source breaks on the way. Thread: the pipeline's; call once.
  void run();
  /// Ends run() soon. Thread: any, also a signal handler.
  void stop() noexcept;
  /// Whether frames have begun to go out: what fails later is no wrong input.
  [[nodiscard]] bool streaming() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
