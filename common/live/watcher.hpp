// SPDX-License-Identifier: MIT
// One watcher of a LiveServer: a WebSocket. A queue of limited size holds the messages that wait
// for the network. When it is full, new messages are lost. The watcher gets a warning with their
// number at once, then once a second, and when the queue is empty again. A limit of bytes in a
// second bounds what a flood of requests or pings costs. Only watcher.cpp has Beast's WebSocket,
// which takes half a minute to compile. Thread: the live server's.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/live/live_protocol.hpp"
#include "common/transport/asio.hpp"

namespace hapticast {

/// A message for watchers.
struct LiveMessage {
  std::size_t channel;
  std::uint64_t time_ns;
  std::vector<std::uint8_t> data;
};

/// A connected watcher.
class Watcher : public std::enable_shared_from_this<Watcher> {
 public:
  /// Largest number of bytes that wait for the network. Chosen: 10 s of a stream with pictures.
  static constexpr std::size_t kMostWaitingBytes = 4U << 20U;
  /// Largest number of bytes in a second from a watcher. Chosen: one request of the largest size.
  static constexpr std::size_t kMostBytesPerSecond = kMostRequestBytes;
  /// Largest number of subscriptions. Chosen: several for each channel.
  static constexpr std::size_t kMostSubscriptions = 64;

  /// What a watcher needs of its server.
  struct Server {
    std::string info;           ///< makeServerInfo()
    std::string advertisement;  ///< makeAdvertisement()
    std::size_t channels;       ///< number of channels
    /// Returns whether one more watcher may open its WebSocket.
    std::function<bool()> hasPlace;
    /// A subscription to a channel begins or ends. The watcher ends all its subscriptions before
    /// its destruction.
    std::function<void(Watcher& watcher, std::size_t channel, bool begins)> onSubscription;
  };

  /// `server` must outlive the watcher.
  Watcher(asio::ip::tcp::socket socket, const Server& server);
  ~Watcher();
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

  /// Serves the connection until it ends.
  asio::awaitable<void> serve();
  /// Queues `message` for each subscription to its channel.
  void send(const std::shared_ptr<const LiveMessage>& message);
  /// Closes the connection.
  void close();
  /// Returns whether the connection has a place: it has asked for a WebSocket.
  [[nodiscard]] bool hasPlace() const { return has_place_; }

 private:
  struct Socket;
  /// A message in the queue: a text, or a LiveMessage for one subscription.
  struct Waiting {
    std::string text;
    std::shared_ptr<const LiveMessage> message;
    std::uint32_t subscription = 0;
    [[nodiscard]] std::size_t size() const { return message ? message->data.size() : text.size(); }
  };
  /// Answers the request for a WebSocket. Returns whether it is open.
  asio::awaitable<bool> accept();
  void obey(const LiveRequest& request);
  void begin(const LiveRequest::Subscription& subscription);
  void push(Waiting waiting);
  void enqueue(Waiting waiting);
  /// Queues the number of lost messages.
  void warnOfLost();
  asio::awaitable<void> writeAll();

  std::unique_ptr<Socket> socket_;
  const Server& server_;
  std::map<std::uint32_t, std::size_t> subscriptions_;  // channels, by the watcher's number
  std::deque<Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  std::uint64_t lost_ = 0;  // since the last warning
  std::chrono::steady_clock::time_point warned_at_{};
  bool has_place_ = false, is_open_ = false, writes_ = false;
};

/// Returns whether a page of `origin` may watch a server whose address the request names `host`. A
/// page of any site can open a WebSocket to this machine, so only programs (no origin), local
/// files, pages of this machine, and pages of the IP address of the server may.
[[nodiscard]] bool isTrustedPage(std::string_view origin, std::string_view host);

}  // namespace hapticast
