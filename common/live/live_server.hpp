// SPDX-License-Identifier: MIT
// Shows the messages of a run while they are made (--live), by Foxglove's WebSocket protocol
// (live_protocol.hpp). It is read-only, and has a thread of its own: a slow watcher loses messages
// and delays no other thread. Thread: see each function.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/endpoint.hpp"
#include "common/live/watcher.hpp"
#include "common/recording/mcap_records.hpp"
#include "common/transport/asio.hpp"

namespace hapticast {

/// A port for watchers.
class LiveServer {
 public:
  /// Largest number of WebSockets. A further one is refused. Chosen.
  static constexpr std::size_t kMostWatchers = 8;
  /// Largest number of connections without a WebSocket. One more replaces the oldest. Chosen.
  static constexpr std::size_t kMostSilent = 32;

  /// Opens the port of `address` as openPort() does, and starts the thread. `name`: of the program,
  /// for watchers. Throws AddressError or std::runtime_error with one line.
  LiveServer(const Endpoint& address, const std::string& name, std::vector<McapChannel> channels);
  /// Closes the port and all connections.
  ~LiveServer();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

  /// Sends a message to all watchers of a channel. `time_ns`: time of its content. Never waits for
  /// the network. Without memory, the message is lost. Thread: any.
  void push(std::size_t channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Returns whether push() uses a message of this channel: it has a watcher, or a later watcher
  /// gets its newest message. Thread: any.
  [[nodiscard]] bool isWanted(std::size_t channel) const;
  /// Returns the address, with the actual port.
  [[nodiscard]] const Endpoint& address() const { return address_; }

 private:
  void run();
  asio::awaitable<void> acceptAll();
  void add(asio::ip::tcp::socket socket);
  [[nodiscard]] std::size_t countWatchers() const;
  asio::awaitable<void> serve(std::shared_ptr<Watcher> watcher);
  void onSubscription(Watcher& watcher, std::size_t channel, bool begins);
  void deliver(std::shared_ptr<const LiveMessage> message);

  const std::vector<McapChannel> channels_;
  std::vector<std::atomic<std::uint32_t>> subscriptions_;  // by channel
  asio::io_context io_{1};
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_{io_};
  Endpoint address_;
  Watcher::Server server_;
  std::vector<std::shared_ptr<const LiveMessage>> newest_;  // by channel, where it is a state
  std::vector<std::shared_ptr<Watcher>> watchers_;
  std::jthread thread_;  // last member: it uses all others; it ends when nothing is open
};

}  // namespace hapticast
