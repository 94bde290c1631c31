// SPDX-License-Identifier: MIT
// Composition root of the server: source and vision on the calling thread, encoding on a second
// thread (EncoderThread), the network on a third.
#pragma once

#include <memory>

#include "common/time.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// One server.
class App {
 public:
  /// Opens the source and the port. Throws SourceError, AddressError or std::runtime_error, one
  /// line each. `clock` must outlive App.
  App(Settings settings, const Clock& clock);
  ~App();
  App(const App&) = delete;
  App& operator=(const App&) = delete;

  /// Streams until the clip ends (without --loop), --frames frames are done, or stop(). Throws
  /// SourceError if the source fails later. Call once. Thread: the pipeline's.
  void run();
  /// Makes run() return soon. Thread: any, also a signal handler.
  void stop() noexcept;
  /// Returns whether streaming has begun; later failures are not wrong input.
  [[nodiscard]] bool streaming() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hapticast::server
