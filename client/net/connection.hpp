// SPDX-License-Identifier: MIT
// Connection to a server: the sockets around a ClientSession, which knows the protocol. It dials
// the server and carries the bytes of the session in both directions, datagrams included. After a
// loss it reconnects, with exponential backoff. The Receiver processes the frames.
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

#include "client/net/client_session.hpp"
#include "client/net/dial.hpp"
#include "client/net/receiver.hpp"
#include "client/net/udp/datagram_key_ring.hpp"
#include "client/net/udp/udp_receiver.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::client {

/// connect_deadline limits each of three steps: the look-up of the name, the connection, and the
/// welcome.
struct ConnectionSettings : SessionSettings {
  Endpoint server{"127.0.0.1", kDefaultPort};
  Dial dial = dialTcp;
  DeliverySettings delivery;
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
  void setInContact(bool in_contact) { session_.setInContact(in_contact); }
  /// Returns whether the link carries fewer pictures than the stream has.
  [[nodiscard]] bool arePicturesReduced() const { return session_.arePicturesReduced(); }
  /// Returns the number of bytes received in all sessions.
  [[nodiscard]] std::uint64_t bytesReceived() const;
  /// Returns the datagram counters, summed over all sessions.
  [[nodiscard]] DatagramCounts datagrams() const;
  /// Returns the present transport and its quality. Without a session they are those of the last
  /// session.
  [[nodiscard]] DeliveryStats delivery() const;

 private:
  struct Sockets;  // of one session
  using SocketsPtr = std::shared_ptr<Sockets>;

  /// Runs one session after the other, with pauses, until stop() or an error after which a retry is
  /// useless.
  asio::awaitable<void> run();
  asio::awaitable<SessionEnd> runSession();
  asio::awaitable<SessionEnd> readAll(SocketsPtr sockets);
  /// Sends what the session has for the server. Only this coroutine writes.
  asio::awaitable<void> writeLoop(SocketsPtr sockets);
  /// Closes the sockets after a time limit of the session.
  asio::awaitable<void> watch(SocketsPtr sockets);
  void handle(Sockets& sockets, Message message);
  void onWelcome(Sockets& sockets, const Welcome& welcome);
  void openDatagrams(Sockets& sockets, const Welcome& welcome);
  /// Ends the datagrams of the previous welcome.
  void closeDatagrams(Sockets& sockets);

  asio::io_context& io_;
  const Clock& clock_;
  ConnectionSettings settings_;
  Receiver& receiver_;
  ConnectionEvents events_;
  DatagramKeyRing keys_;  // of the newest welcome
  asio::steady_timer retry_;
  DialCancellation dial_stop_;
  ClientSession session_;
  SocketsPtr sockets_;  // null: not connected
  bool stopped_ = false;
  std::uint64_t bytes_received_ = 0;  // of the ended sessions
  DatagramCounts datagrams_;          // of the ended sessions
  DeliveryStats delivery_;            // without datagrams
};

}  // namespace hapticast::client
