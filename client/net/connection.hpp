// SPDX-License-Identifier: MIT
// The connection to a server: dial, hello, pings, and back again whenever it breaks. Protocol only:
// the bytes travel through a channel. Hands what arrives to the receiver. Thread: network (the one
// that runs `io`), except where a function says "any".
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
  Duration connect_deadline = std::chrono::seconds(5);    ///< look-up, connection and welcome, each
  Duration silence_limit = std::chrono::seconds(3);       ///< without a message from the server
  Duration first_retry = std::chrono::milliseconds(200);  ///< doubled up to `last_retry`
  Duration last_retry = std::chrono::seconds(1);
  /// A connection that has brought frames for so long was a good one: after it, and only after it,
  /// the pauses begin anew. Chosen: a server that errs after every welcome is tried once a second.
  Duration good_after = std::chrono::seconds(3);
  Duration pong_limit = std::chrono::seconds(5);  ///< welcomed, and no ping answered
  Duration ping_interval = std::chrono::seconds(1);
  Duration burst_interval =
      std::chrono::milliseconds(20);  ///< of the first ClockSync::kBurst pings
};

/// Called on the network thread; each may be empty.
struct ConnectionEvents {
  std::function<void(const StreamDescription&)> welcomed;  ///< a connection is made
  std::function<void(VideoFrame)> video;
  std::function<void(double)> preparing;  ///< the share of its clip a server has looked through
  std::function<void(const std::string&)> delivery;      ///< another way for the frames, one line
  std::function<void(const std::string&)> disconnected;  ///< why, one line; it will be tried again
  std::function<void(const std::string&)> failed;        ///< why, one line; it is over
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
  [[nodiscard]] std::uint64_t bytesReceived() const;
  [[nodiscard]] DatagramCounts datagrams() const;
  /// As it is, or was when the last connection ended.
  [[nodiscard]] DeliveryStats delivery() const;

 private:
  struct Session;  // with one server over one channel
  using ConversationPtr = std::shared_ptr<Session>;
  /// How a conversation ended.
  struct CloseReason {
    std::string why;                // one line
    std::optional<ErrorCode> code;  // where the protocol has one for it
    bool no_such_server = false;
  };

  asio::awaitable<void> run();
  /// Whether it is useless to try again: the server speaks another version of the protocol; or,
  /// while none was ever reached, its name does not exist or it speaks something else.
  [[nodiscard]] bool isPermanent(const CloseReason& ending) const;
  asio::awaitable<CloseReason> runSession();
  asio::awaitable<CloseReason> readAll(ConversationPtr session);
  /// Pings, reports, and orders where frames shall come; the only one who writes.
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
  std::uint64_t bytes_received_ = 0;  // of the conversations that have ended
  DatagramCounts datagrams_;          // the same
  DeliveryStats delivery_;            // of the last of them
};

}  // namespace hapticast::client
