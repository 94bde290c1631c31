// SPDX-License-Identifier: MIT
// Session of one viewer: the states of the protocol from hello and welcome to goodbye, answers to
// pings, the send queue and deadlines. A Channel transmits the session's bytes. If it has received
// a request of HTTP instead, the session only watches over the answer. The coroutines of the
// session keep it alive. The session never blocks, and its memory is bounded. Thread: the
// network's.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/protocol/messages.hpp"
#include "common/transport/channel.hpp"
#include "server/stream/access_list.hpp"
#include "server/stream/send_queue.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

class Session;

/// Interface of a session's owner, the broadcaster. Thread: the network's.
class SessionHost {
 public:
  [[nodiscard]] virtual const Clock& clock() const = 0;
  [[nodiscard]] virtual const MediaClock& mediaClock() const = 0;
  [[nodiscard]] virtual const StreamSettings& settings() const = 0;
  [[nodiscard]] virtual const StreamDescription& description() const = 0;
  /// Returns the reason to refuse the client of `hello` on `channel`, or nullopt to welcome it.
  [[nodiscard]] virtual std::optional<WireError> refuse(const Hello& hello,
                                                        const Channel& channel) const = 0;
  /// Reserves a time for the answer to the wrong token of `session`, and returns it. Returns
  /// nullopt if there is none until `latest`: too many wrong tokens came from the same network.
  [[nodiscard]] virtual std::optional<LocalTime> reserveRefusal(const Session& session,
                                                                LocalTime latest) = 0;
  /// Returns the rights of the token in `hello`; nullopt if this server needs no tokens.
  [[nodiscard]] virtual std::optional<Grant> findGrant(const Hello& hello) const = 0;
  /// Passes the request of a client on. The host calls confirm() of `sender` once the request is
  /// carried out, or on demand at once. Returns an error if the client may not request that.
  [[nodiscard]] virtual std::optional<WireError> control(
      const Control& control, const std::shared_ptr<Session>& sender) = 0;
  /// Writes the key of the stream into `welcome`, and the parameters for datagrams, if datagrams
  /// are available to the client of `channel`.
  virtual void completeWelcome(const Channel& channel, Welcome& welcome) = 0;
  /// Sets transport and redundancy of the frames for the client with this token.
  virtual void deliver(std::uint64_t datagram_token, const Delivery& delivery) = 0;
  /// The session calls this when its channel begins to answer a request of HTTP. `problem`: what is
  /// wrong with the request, in one line; empty: nothing.
  virtual void onRequest(const std::shared_ptr<Session>& session, const std::string& problem) = 0;
  /// The session calls this after its welcome: its client is a viewer now.
  virtual void onJoined(Session& session) = 0;
  /// The session calls this at most once, when it begins to close. Its client is no viewer from
  /// then on. `why` is the reason if this server closes the session, or nullopt if the client does.
  virtual void onClosing(const std::shared_ptr<Session>& session,
                         const std::optional<WireError>& why) = 0;
  /// The session calls this at the end of its connection, possibly more than once.
  virtual void onClosed(const std::shared_ptr<Session>& session) = 0;

 protected:
  ~SessionHost() = default;
};

/// Session of one connection. Create it with std::make_shared.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// Largest number of pings that wait for their answer; a choice.
  static constexpr std::size_t kMaxPongs = 64;
  static constexpr std::uint32_t kMaxMessagesPerSecond = 200;
  /// Largest number of an operator's requests that are not carried out yet; a choice.
  static constexpr std::size_t kMaxUnconfirmed = 1000;

  /// `io` runs the channel. `host` must outlive the session's coroutines. `id`: number for the log.
  Session(asio::io_context& io, std::unique_ptr<Channel> channel, SessionHost& host,
          std::uint32_t id);

  /// Begins to read and to write.
  void start();
  /// Add an item to the queue without sending it; call flush() afterwards. Until then newer items
  /// may replace it.
  void queue(const EncodedFrame& frame);
  void queue(const EncodedVideo& video);
  void queue(const SharedBytes& control);
  /// Adds a description of the stream to the queue, in place of one that waits; call flush()
  /// afterwards. Does nothing before the welcome. `other_picture`: the workspace is new, so frames
  /// and pictures in the queue are removed.
  void queue(const SharedBytes& description, bool other_picture);
  void queue() {}
  /// Makes the next frame a key frame, because the stream left out frames before it.
  void requireKeyFrame() { queue_.requireKeyFrame(); }
  /// Sends as much of the queue as the connection accepts at once. The writer coroutine sends the
  /// rest. A direct send costs far less time than a wake-up of that coroutine. flush() never ends
  /// the session.
  void flush();
  /// Adds the items to the queue and sends as much as possible, as queue() and flush() do.
  template <class... What>
  void send(const What&... what) {
    queue(what...);
    flush();
  }
  /// Sends `frame` like the other send(). If the queue is empty, which is usual, the frame bypasses
  /// the queue.
  void send(const EncodedFrame& frame);
  /// Returns the request of this operator to its client, because it is carried out.
  void confirm(const Control& control);
  /// Sends another welcome after a change of the origin. Removes waiting items and pongs, because
  /// they belong to the previous origin. Resets the delivery of frames to the request in the
  /// client's hello. Requires a welcomed client.
  void welcomeAgain();
  /// Removes all waiting items, sends the reason `why` to the client, then closes the connection.
  void close(const WireError& why);
  /// Closes the connection at once, without a message to the client.
  void abort();
  /// Checks the deadlines and closes the session if one has passed. Call it regularly.
  void check(LocalTime now);

  [[nodiscard]] bool welcomed() const { return hello_.has_value() && !closing_since_; }
  [[nodiscard]] std::uint64_t datagramToken() const { return datagram_token_; }
  [[nodiscard]] bool isVideoSubscriber() const { return welcomed() && wants_pictures_; }
  /// Returns the rights of the client's token; nullopt if the server needs no tokens.
  [[nodiscard]] const std::optional<Grant>& grant() const { return grant_; }
  /// Returns the name that the client gives itself; empty before its hello.
  [[nodiscard]] std::string name() const { return hello_ ? hello_->client_name : ""; }
  /// Returns whether the client is an operator that receives the acts of other operators.
  [[nodiscard]] bool wantsActs() const {
    return welcomed() && hello_->wants_acts && grant_ && grant_->role == Role::kOperator;
  }
  [[nodiscard]] bool encrypted() const { return channel_->encrypted(); }
  /// Returns whether its client is connected by a WebSocket.
  [[nodiscard]] bool ofWebSocket() const { return channel_->carrier() == Carrier::kWebSocket; }
  [[nodiscard]] std::string label() const;    ///< names the client in the log
  [[nodiscard]] std::string address() const;  ///< client's address, without its port
  /// Returns a text that is the same for all addresses that one client may use: of IPv6, the first
  /// 64 bits.
  [[nodiscard]] const std::string& network() const { return network_; }
  [[nodiscard]] const SendCounts& counts() const { return queue_.counts(); }
  [[nodiscard]] std::uint64_t bytesSent() const { return channel_->bytesWritten(); }

 private:
  asio::awaitable<void> readAll();
  asio::awaitable<void> writeAll();
  /// Answers a request of HTTP, then ends the session.
  asio::awaitable<void> answerRequest();
  /// Ends the session if its answer has arrived, or makes no progress, or lasts too long.
  void checkAnswer(LocalTime now);
  void onPayload(Payload payload);
  void handle(const Hello& hello);
  void handle(const Ping& ping);
  void handle(const Delivery& delivery);
  void handle(const ReceiverReport& report);
  void handle(const Control& control);
  void handle(const Receipt& receipt);
  template <class Other>
  void handle(const Other& other);
  /// Adds a welcome to the queue, as its first item. Requires an empty queue.
  void queueWelcome();
  /// Refuses the client. Answers a wrong token at the time that the host reserves. Until then the
  /// session discards what the client sends. Aborts the connection if there is no such time before
  /// the deadline of the hello.
  void refuse(const WireError& why);
  [[nodiscard]] bool isWithinRate();
  /// Returns whether a write is unfinished and the client has read no byte of it for write_timeout
  /// or longer.
  [[nodiscard]] bool stalled(LocalTime now);
  /// Sends `farewell` to the client as the last message. `why` is the argument for the host's
  /// onClosing().
  void sendGoodbye(const WireError& farewell, const std::optional<WireError>& why);
  void end();
  [[nodiscard]] SharedBytes nextPayload();
  [[nodiscard]] SharedBytes popPong();
  /// Returns whether nextPayload() surely returns another payload.
  [[nodiscard]] bool payloadWaits() const { return !pongs_.empty() || !queue_.empty(); }
  void wakeWriter();

  // With a thousand viewers, each session has left the cache at its turn. So the members that
  // send() uses are adjacent.
  std::unique_ptr<Channel> channel_;
  bool idle_ = false;  // the writer sleeps, and the queue is empty
  bool frames_on_tcp_ = false;
  SendQueue queue_;
  asio::io_context& io_;
  asio::steady_timer wake_;  // wakes the writer
  SessionHost& host_;
  std::uint32_t id_;
  std::string network_;
  SharedBytes unfinished_;       // payload that is written in part; the writer continues with it
  std::deque<Pong> pongs_;       // t2 and error are set when the pong is sent
  std::size_t quick_pongs_ = 0;  // pongs that were sent at once, since the newest welcome
  std::size_t unconfirmed_ = 0;  // requests of this operator that are not carried out yet
  std::optional<Hello> hello_;   // without its token
  bool wants_pictures_ = false;
  std::optional<Grant> grant_;
  std::uint64_t datagram_token_ = 0;  // 0: none was offered
  LocalTime started_;
  LocalTime received_;  // time of the last message
  bool ended_ = false;
  bool read_ended_ = false;   // nothing more from the client matters
  bool write_ended_ = false;  // the last message is written
  bool writer_sleeps_ = false;
  bool writing_ = false;
  LocalTime write_progress_;  // last time at which the client read bytes
  std::uint64_t bytes_delivered_ = 0;
  std::optional<WireError> refusal_;  // waits for refusal_time_
  LocalTime refusal_time_;
  std::optional<LocalTime> answering_since_;  // a request of HTTP
  std::optional<LocalTime> closing_since_;
  LocalTime rate_since_;
  std::uint32_t rate_count_ = 0;
};

}  // namespace hapticast::server
