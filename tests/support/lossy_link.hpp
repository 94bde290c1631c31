// SPDX-License-Identifier: MIT
// A bad network on 127.0.0.1 for tests: relays TCP connections to a port with seeded delay and
// jitter, can stall and cut them. Order is kept, as TCP does. Thread: the one that runs the
// io_context.
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "common/time.hpp"
#include "common/wire/asio.hpp"

namespace hapticast::testing {

class LossyLink {
 public:
  struct Profile {
    Duration delay{0};   ///< of each way
    Duration jitter{0};  ///< uniform, on top
    std::uint32_t seed = 1;
  };

  /// Relays to 127.0.0.1:`target`. Outlives the work on `io`.
  LossyLink(asio::io_context& io, std::uint16_t target, Profile profile);

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  /// While stalled, connections stay open and nothing passes.
  void stall(bool stalled) { stalled_ = stalled; }
  /// Resets every connection; new ones are accepted.
  void cut();
  /// Accepts nothing any more and cuts.
  void close();

 private:
  struct Relay;  // one connection
  struct Way;    // one direction of it
  asio::awaitable<void> acceptAll();
  asio::awaitable<void> take(std::shared_ptr<Relay> relay, std::shared_ptr<Way> way);
  asio::awaitable<void> deliver(std::shared_ptr<Relay> relay, std::shared_ptr<Way> way);

  asio::ip::tcp::acceptor acceptor_;
  std::uint16_t target_;
  Profile profile_;
  std::mt19937 random_;
  bool stalled_ = false;
  std::vector<std::weak_ptr<Relay>> relays_;
};

}  // namespace hapticast::testing
