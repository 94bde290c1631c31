// SPDX-License-Identifier: MIT
// The servers of a crowd of viewers, each in a process of its own, so that the kernel counts
// what it computes: the server's broadcaster without any vision, the least that could serve them,
// and message brokers. Thread: main, before it has started any other.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "tests/bench/viewers/dialect.hpp"

namespace hapticast::testing {

/// Whether frames are to come; shared by processes.
class Switch {
 public:
  Switch();
  ~Switch();
  Switch(const Switch&) = delete;
  Switch& operator=(const Switch&) = delete;
  [[nodiscard]] bool on() const { return on_->load(std::memory_order_relaxed); }
  void set(bool on) { on_->store(on, std::memory_order_relaxed); }

 private:
  std::atomic<bool>* on_;
};

/// A child process that listens on a port.
class ServerProcess {
 public:
  /// Runs in the child, calls its argument once with the port, and never returns.
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
/// another. `playing` outlives the process, as below.
[[nodiscard]] ServerProcess::Serve broadcaster(const Frames& frames, const Switch& playing);
/// A loop around send(): waits for all the viewers, then sends every frame to one after the other.
[[nodiscard]] ServerProcess::Serve bareLoop(const Frames& frames, const Switch& playing);
/// The same around sendto(), with each datagram ready in one piece.
[[nodiscard]] ServerProcess::Serve bareDatagrams(const Frames& frames, const Switch& playing);
/// The broker of this way, as Debian installs it, set up to listen on loopback only.
[[nodiscard]] ServerProcess::Serve broker(Transport way);
/// Publishes frames to a broker; its port is that one.
[[nodiscard]] ServerProcess::Serve publisher(Transport way, std::uint16_t port,
                                             const Frames& frames, const Switch& playing);

}  // namespace hapticast::testing
