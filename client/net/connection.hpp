// SPDX-License-Identifier: MIT
// The protocol session with a server: dial, hello, welcome, pings, reports, and reconnection with
// exponential back-off. A channel carries the bytes; the receiver processes the frames.
// Thread: network (the thread that runs `io`), except where a function says "any".
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/net/dial.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/udp_receiver.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

struct ConnectionSettings {
  Endpoint server{"127.0.0.1", kDefaultPort};
  Dial dial = dialTcp;
  DeliverySettings delivery;
  std::string client_name = "hapticast-client";
  bool wants_video = false;
  /// Limit for look-up, connection and welcome, each.
  Duration connect_deadline = std::chrono::seconds(5);
  /// Longest time without a message from the server.
  Duration silence_limit = std::chrono::seconds(3);
  Duration first_retry = std::chrono::milliseconds(200);  ///< doubled up to last_retry
  Duration last_retry = std::chrono::seconds(1);
  /// A connection that brought frames for this long was good. Only a good one resets the retry
  /// pause. Chosen: a server with an error after every welcome is retried once a second.
  Duration good_after = std::chrono::seconds(3);
  /// Longest time after the welcome without an answered ping.
  Duration pong_limit = std::chrono::seconds(5);
  Duration ping_interval = std::chrono::seconds(1);
  Duration burst_interval =
      std::chrono::milliseconds(20);  ///< interval of the first ClockSync::kBurst pings
};

/// Callbacks in the network thread; each may be empty.
struct ConnectionEvents {
  std::function<void(const StreamDescription&)> welcomed;  ///< connected
  std::function<void(VideoFrame)> video;
  std::function<void(double)> preparing;  ///< share of its clip that the server has prepared, 0..1
  std::function<void(const std::string&)> delivery;      ///< change of the transport, one line
  std::function<void(const std::string&)> disconnected;  ///< cause, one line; a retry follows
  std::function<void(const std::string&)> failed;        ///< cause, one line; no retry follows
};

/// Connects to a server and reconnects after each loss.
class Connection {
 public:
  /// `clock`, `receiver` and this object must outlive the work on `io`.
  Connection(asio::io_context& io, const Clock& clock, ConnectionSettings settings,
             Receiver& receiver, ConnectionEvents events);

  /// Begins to connect. Call once.
  void start();
  /// Ends the connection for good, so that `io` runs out of work. A pending name look-up may last
  /// some seconds longer. Thread: any.
  void stop();
  /// Sets the contact flag of the reports to the server.
  void setInContact(bool in_contact) { in_contact_ = in_contact; }
  /// Bytes of all sessions so far.
  [[nodiscard]] std::uint64_t bytesReceived() const;
  /// Datagram counters of all sessions so far.
  [[nodiscard]] DatagramCounts datagrams() const;
  /// Present delivery, or that of the last session.
  [[nodiscard]] DeliveryStats delivery() const;

 private:
  struct Session;  // a session with one server over one channel
  using ConversationPtr = std::shared_ptr<Session>;
  /// End of a session.
  struct CloseReason {
    std::string why;                // one line
    std::optional<ErrorCode> code;  // code of the protocol, if it has one
    bool no_such_server = false;
  };

  /// Loop over sessions and retries, until stop() or a permanent error.
  asio::awaitable<void> run();
  /// Returns true if a retry is useless. The first case is a server of another protocol version.
  /// The second case needs that no server was ever reached: the host name does not exist, or the
  /// peer uses another protocol.
  [[nodiscard]] bool isPermanent(const CloseReason& ending) const;
  asio::awaitable<CloseReason> runSession();
  asio::awaitable<CloseReason> readAll(ConversationPtr session);
  /// Sends pings, reports and delivery requests. The only writer after the hello.
  asio::awaitable<void> writeLoop(ConversationPtr session);
  asio::awaitable<bool> ping(ConversationPtr session, bool with_report);
  void openLink(Session& session, const Welcome& welcome);
  asio::awaitable<void> startTimer(ConversationPtr session);
  asio::awaitable<bool> send(ConversationPtr session, Message message);
  [[nodiscard]] std::optional<WireError> handle(Session& session, Message message);
  [[nodiscard]] std::optional<WireError> handleWelcome(Session& session, const Message& message);
  void handlePong(Session& session, const Pong& pong);
  [[nodiscard]] ReceiverReport report() const;

  asio::io_context& io_;
  const Clock& clock_;
  ConnectionSettings settings_;
  Receiver& receiver_;
  ConnectionEvents events_;
  asio::steady_timer retry_;
  DialCancellation dial_stop_;
  ConversationPtr session_;
  bool stopped_ = false;
  bool ever_welcomed_ = false;
  bool in_contact_ = false;
  std::uint64_t bytes_received_ = 0;  // of the ended sessions
  DatagramCounts datagrams_;          // of the ended sessions
  DeliveryStats delivery_;            // of the last session
};

}  // namespace hapticast::client
