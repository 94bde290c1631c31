// SPDX-License-Identifier: MIT
// What a crowd of viewers is served by, each in a process of its own, so that the kernel counts
// what it computes: the server's broadcaster without any vision, and the least that could serve
// them. Thread: main, before it has started any other.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <functional>

namespace hapticast::testing {

/// A child process that listens on a port.
class ServerProcess {
 public:
  /// `serve` runs in the child, calls its argument once with the port, and never returns.
  using Serve = std::function<void(const std::function<void(std::uint16_t)>&)>;
  explicit ServerProcess(const Serve& serve);
  ~ServerProcess();  ///< kills it
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  [[nodiscard]] pid_t id() const { return pid_; }
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  pid_t pid_ = -1;
  std::uint16_t port_ = 0;
};

struct Frames {
  std::size_t bytes = 20000;  ///< of the relief of each
  double fps = 30.0;
  std::size_t viewers = 1000;
};

/// The server's own broadcaster and listener on a thread of their own, fed with frames from
/// another.
[[nodiscard]] ServerProcess::Serve broadcaster(const Frames& frames);

/// A loop around send(): waits for all the viewers, then sends every frame to one after the other.
[[nodiscard]] ServerProcess::Serve bareLoop(const Frames& frames);

}  // namespace hapticast::testing
