// SPDX-License-Identifier: MIT
// The control connection to a server: resolve, connect, hello, pings, and back again whenever it
// breaks. Hands what arrives to the receiver. Thread: network (the one that runs `io`), except
// where a function says "any".
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/net/receiver.hpp"
#include "common/result.hpp"
#include "common/wire/asio.hpp"
#include "common/wire/framing.hpp"
#include "common/wire/messages.hpp"

namespace hapticast::client {

struct ConnectionSettings {
  std::string host = "127.0.0.1";
  std::uint16_t port = 7447;
  std::string client_name = "hapticast-client";
  bool wants_video = false;
  /// Keep trying when the server was never reached; otherwise the first failure is fatal. (A full
  /// server is always tried again, one of another protocol version never.)
  bool patient = false;
  Duration connect_deadline = std::chrono::seconds(5);    ///< resolve, connect and welcome, each
  Duration silence_limit = std::chrono::seconds(3);       ///< without a message from the server
  Duration first_retry = std::chrono::milliseconds(200);  ///< doubled up to `last_retry`
  Duration last_retry = std::chrono::seconds(1);
  Duration ping_interval = std::chrono::seconds(1);
  Duration burst_interval =
      std::chrono::milliseconds(20);  ///< of the first ClockSync::kBurst pings
};

/// Called on the network thread; each may be empty.
struct ConnectionEvents {
  std::function<void(const StreamDescription&)> welcomed;  ///< a connection is made
  std::function<void(VideoFrame)> video;
  std::function<void(const std::string&)> disconnected;  ///< one line: why; it will be tried again
  std::function<void(const std::string&)> failed;        ///< one line: why; it is over
};

class Connection {
 public:
  /// `clock`, `receiver` and the connection itself outlive the work on `io`.
  Connection(asio::io_context& io, const Clock& clock, ConnectionSettings settings,
             Receiver& receiver, ConnectionEvents events);

  void start();
  /// Ends for good; `io` then runs out of work (a name look-up under way may take some seconds).
  /// Thread: any.
  void stop();
  /// For the reports to the server.
  void setInContact(bool in_contact) { in_contact_ = in_contact; }
  [[nodiscard]] std::uint64_t bytesReceived() const { return bytes_received_; }

 private:
  struct Link;  // one TCP connection
  using LinkPtr = std::shared_ptr<Link>;
  using Endpoints = asio::ip::tcp::resolver::results_type;

  asio::awaitable<void> run();
  asio::awaitable<Error> attempt();
  asio::awaitable<Result<Endpoints>> resolve();
  asio::awaitable<std::optional<Error>> readAll(LinkPtr link);
  asio::awaitable<void> ping(LinkPtr link);
  asio::awaitable<void> watch(LinkPtr link);
  asio::awaitable<bool> send(LinkPtr link, Message message);
  [[nodiscard]] std::optional<Error> handleChunk(Link& link, std::span<const std::uint8_t> chunk);
  [[nodiscard]] std::optional<Error> handle(Link& link, Message message);
  [[nodiscard]] std::optional<Error> handleWelcome(Link& link, const Message& message);
  void handlePong(Link& link, const Pong& pong);
  [[nodiscard]] Report report() const;
  [[nodiscard]] std::string target() const;

  asio::io_context& io_;
  const Clock& clock_;
  ConnectionSettings settings_;
  Receiver& receiver_;
  ConnectionEvents events_;
  asio::steady_timer retry_;
  LinkPtr link_;
  bool stopped_ = false;
  bool ever_welcomed_ = false;
  bool in_contact_ = false;
  std::uint64_t bytes_received_ = 0;
};

}  // namespace hapticast::client
