// SPDX-License-Identifier: MIT
// Connection to a server by the protocol of proto/README.md. It dials the server, sends the hello
// message and receives the welcome message. Then it receives the stream, and it sends pings and
// reports. After a loss it reconnects, with exponential backoff. A channel carries the bytes, and
// the Receiver processes the frames.
// Thread: network (the thread that runs `io`), except where a function says "any".
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/net/dial.hpp"
#include "client/net/origin_pin.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/datagram_key_ring.hpp"
#include "client/net/udp/udp_receiver.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

struct ConnectionSettings {
  Endpoint server{"127.0.0.1", kDefaultPort};
  Dial dial = dialTcp;
  DeliverySettings delivery;
  OriginPin origin;  ///< check of the server's key
  std::string client_name = "hapticast-client";
  std::string access_token;  ///< secret for the server; empty: none
  /// True: the client may send the token to other machines without TLS.
  bool insecure = false;
  bool wants_video = false;
  /// Time limit for each of three steps: the look-up of the name, the connection, and the welcome.
  Duration connect_deadline = std::chrono::seconds(5);
  /// If no message from the server arrives for this time, the connection counts as lost.
  Duration silence_limit = std::chrono::seconds(3);
  /// First pause before a retry. Each further pause is twice as long, but at most last_retry.
  Duration first_retry = std::chrono::milliseconds(200);
  Duration last_retry = std::chrono::seconds(1);
  /// Only a connection that delivered frames for this time resets the pause to first_retry. Chosen
  /// so that the client retries a server that fails after every welcome only once a second.
  Duration good_after = std::chrono::seconds(3);
  /// If the server answers no ping within this time after the welcome, the connection counts as
  /// lost.
  Duration pong_limit = std::chrono::seconds(5);
  Duration ping_interval = std::chrono::seconds(1);
  Duration burst_interval =
      std::chrono::milliseconds(20);  ///< interval of the first ClockSync::kBurst pings
};

/// Callbacks. The connection calls them in the network thread. Each may be empty.
struct ConnectionEvents {
  /// The server's welcome arrived. For a further welcome of the same session, the connection calls
  /// this only if the description of the stream has changed.
  std::function<void(const StreamDescription&)> welcomed;
  std::function<void(VideoFrame)> video;
  /// The server scans its clip before the first frame; the argument is the scanned share (0..1).
  std::function<void(double)> preparing;
  /// The transport or the origin of the stream has changed; one line for the user.
  std::function<void(const std::string&)> delivery;
  /// The connection was lost, with the cause (one line); a retry follows.
  std::function<void(const std::string&)> disconnected;
  /// The connection has failed, with the cause (one line); no retry follows.
  std::function<void(const std::string&)> failed;
  /// The server has changed the description of the stream during the connection.
  std::function<void(const StreamDescription&)> described = nullptr;
  /// The server has sent its goodbye, because it ends; disconnected() follows.
  std::function<void()> goodbye = nullptr;
};

/// Connects to a server and reconnects after each loss.
class Connection {
 public:
  /// `clock`, `receiver` and this object must outlive the work on `io`.
  Connection(asio::io_context& io, const Clock& clock, ConnectionSettings settings,
             Receiver& receiver, ConnectionEvents events);

  /// Starts to connect. Call it once.
  void start();
  /// Ends the connection without a retry, so that `io` has no more work. A running look-up of the
  /// host name may continue for some seconds. Thread: any.
  void stop();
  /// Requests another pause, place or speed of this viewer's stream. Does nothing where the stream
  /// has no time line, or while many requests wait to be sent.
  void control(const Control& control);
  /// Sets the contact flag that the next reports to the server have.
  void setInContact(bool in_contact) { in_contact_ = in_contact; }
  /// Returns the number of bytes received in all sessions.
  [[nodiscard]] std::uint64_t bytesReceived() const;
  /// Returns the datagram counters, summed over all sessions.
  [[nodiscard]] DatagramCounts datagrams() const;
  /// Returns the present transport and its quality. Without a session they are those of the last
  /// session.
  [[nodiscard]] DeliveryStats delivery() const;

 private:
  struct Session;  // a session with one server over one channel
  using ConversationPtr = std::shared_ptr<Session>;
  /// The reason why a session ended.
  struct CloseReason {
    std::string why;                // one line
    std::optional<ErrorCode> code;  // code of the protocol, if it has one
    bool no_such_server = false;
    bool untrusted = false;  // the server has another key or certificate than expected
  };

  /// Runs one session after the other, with pauses, until stop() or an error after which a retry is
  /// useless.
  asio::awaitable<void> run();
  /// Returns true if a retry is useless: the server has another protocol version, shows an
  /// unexpected key or certificate, or refuses the access token. Before the first welcome of a
  /// server, two more causes make a retry useless: the host name does not exist, or the peer uses
  /// another protocol.
  [[nodiscard]] bool isPermanent(const CloseReason& ending) const;
  asio::awaitable<CloseReason> runSession();
  asio::awaitable<CloseReason> readAll(ConversationPtr session);
  /// Sends pings, reports and delivery requests. After the hello only this coroutine writes.
  asio::awaitable<void> writeLoop(ConversationPtr session);
  asio::awaitable<bool> ping(ConversationPtr session, bool with_report);
  void openLink(Session& session, const Welcome& welcome);
  asio::awaitable<void> startTimer(ConversationPtr session);
  asio::awaitable<bool> send(ConversationPtr session, Message message);
  [[nodiscard]] std::optional<WireError> handle(Session& session, Message message);
  [[nodiscard]] static std::optional<WireError> checkSignature(const Session& session,
                                                               const Message& message,
                                                               std::span<const std::uint8_t> bytes);
  /// Begins the stream of `welcome`. A second welcome in a session means that the edge receives the
  /// stream from another origin from then on: clock, key, frame ids and datagrams start again.
  [[nodiscard]] std::optional<WireError> handleWelcome(Session& session, const Welcome& welcome);
  /// Ends the stream of the previous welcome, but not the session.
  void leaveOrigin(Session& session);
  [[nodiscard]] std::optional<WireError> handleKey(const DatagramKey& key);
  void handlePong(Session& session, const Pong& pong);
  [[nodiscard]] ReceiverReport report() const;

  asio::io_context& io_;
  const Clock& clock_;
  ConnectionSettings settings_;
  Receiver& receiver_;
  ConnectionEvents events_;
  DatagramKeyRing keys_;  // of the newest welcome
  asio::steady_timer retry_;
  DialCancellation dial_stop_;
  ConversationPtr session_;
  bool stopped_ = false;
  bool ever_welcomed_ = false;
  bool in_contact_ = false;
  std::uint64_t bytes_received_ = 0;  // of the ended sessions
  DatagramCounts datagrams_;          // of the ended sessions
  DeliveryStats delivery_;            // without a link
};

}  // namespace hapticast::client
