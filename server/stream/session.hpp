// SPDX-License-Identifier: MIT
// One viewer: hello and welcome, pings, the queue of what is to be sent, and how it ends. Protocol
// only: the bytes travel through a channel. Its coroutines own it; it never blocks and never grows.
// Thread: io.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "common/protocol/messages.hpp"
#include "common/transport/channel.hpp"
#include "server/stream/send_queue.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

class Session;

/// What a session asks of those who keep it.
class SessionHost {
 public:
  [[nodiscard]] virtual const Clock& clock() const = 0;
  [[nodiscard]] virtual const MediaClock& mediaClock() const = 0;
  [[nodiscard]] virtual const StreamSettings& settings() const = 0;
  [[nodiscard]] virtual const StreamDescription& description() const = 0;
  /// Why this client cannot be welcomed, if so.
  [[nodiscard]] virtual std::optional<WireError> refuse(const Hello& hello) const = 0;
  /// Writes into the welcome what this client is told of datagrams, if anything.
  virtual void offerDatagrams(const Hosts& hosts, Welcome& welcome) = 0;
  /// How the client that has this token wants its frames.
  virtual void deliver(std::uint64_t datagram_token, const Delivery& delivery) = 0;
  /// The session has welcomed its client.
  virtual void onJoined(Session& session) = 0;
  /// The session is no viewer any more: it ends by our decision, or, without a reason, by its
  /// peer's. Said at most once.
  virtual void onClosing(const std::shared_ptr<Session>& session,
                         const std::optional<WireError>& why) = 0;
  /// The connection has ended. May be said more than once.
  virtual void onClosed(const std::shared_ptr<Session>& session) = 0;

 protected:
  ~SessionHost() = default;
};

class Session : public std::enable_shared_from_this<Session> {
 public:
  static constexpr std::size_t kMaxPongs = 64;  ///< pings answered at once; chosen
  static constexpr std::uint32_t kMaxMessagesPerSecond = 200;

  /// `io` runs the channel; `host` outlives the session's coroutines.
  Session(asio::io_context& io, std::unique_ptr<Channel> channel, SessionHost& host,
          std::uint32_t id);

  void start();
  /// Puts it into the queue, where newer ones may replace it until flush().
  void queue(const EncodedFrame& frame);
  void queue(const EncodedVideo& video);
  void queue(const SharedBytes& control);
  /// A description. `other_picture`: what waits belongs to another workspace and is forgotten.
  void queue(const SharedBytes& description, bool other_picture);
  void queue() {}
  /// Sends what waits, as far as the connection takes it at once, which costs far less than to wake
  /// the writer; what is left is the writer's. Never ends the session.
  void flush();
  /// queue() and flush().
  template <class... What>
  void send(const What&... what) {
    queue(what...);
    flush();
  }
  /// The same, but past the queue where nothing waits: most frames find it so.
  void send(const EncodedFrame& frame);
  /// Tells the peer why, then closes; what still waits is forgotten.
  void close(const WireError& why);
  /// Ends it at once, without a word to the peer.
  void abort();
  /// Looks after the deadlines; called regularly.
  void check(LocalTime now);

  [[nodiscard]] bool welcomed() const { return hello_.has_value() && !closing_since_; }
  [[nodiscard]] std::uint64_t datagramToken() const { return datagram_token_; }
  [[nodiscard]] bool isVideoSubscriber() const { return welcomed() && hello_->wants_video; }
  [[nodiscard]] std::string label() const;    ///< for the log
  [[nodiscard]] std::string address() const;  ///< the peer's, without its port
  [[nodiscard]] const SendCounts& counts() const { return queue_.counts(); }

 private:
  asio::awaitable<void> readAll();
  asio::awaitable<void> writeAll();
  void onPayload(Payload payload);
  void handle(const Hello& hello);
  void handle(const Ping& ping);
  void handle(const Delivery& delivery);
  void handle(const ReceiverReport& report);
  template <class Other>
  void handle(const Other& other);
  [[nodiscard]] bool withinRate();
  /// Whether the peer has taken nothing of what is being written for too long.
  [[nodiscard]] bool stalled(LocalTime now);
  /// Says the last word; `why` is told to the host.
  void sendGoodbye(const WireError& farewell, const std::optional<WireError>& why);
  void end();
  [[nodiscard]] SharedBytes nextPayload();
  void wakeWriter();

  // With a thousand viewers each is out of the processor's cache when its turn comes: what send()
  // touches stands together.
  std::unique_ptr<Channel> channel_;
  bool idle_ = false;  // the writer sleeps, and nothing waits to be sent
  bool frames_on_tcp_ = false;
  SendQueue queue_;
  asio::io_context& io_;
  asio::steady_timer wake_;  // the writer sleeps on it
  SessionHost& host_;
  std::uint32_t id_;
  SharedBytes unfinished_;  // a part of it is on the way; the writer's next
  std::deque<Pong> pongs_;  // t2 is filled in when one is sent
  std::optional<Hello> hello_;
  std::uint64_t datagram_token_ = 0;  // 0: it was offered none
  LocalTime started_;
  LocalTime received_;  // last message
  bool ended_ = false;
  bool read_ended_ = false;   // nothing more comes from the peer, or nothing that matters
  bool write_ended_ = false;  // the last word is written
  bool writer_sleeps_ = false;
  bool writing_ = false;
  LocalTime write_progress_;  // when the peer was last seen to take something
  std::uint64_t bytes_read_ = 0;
  std::optional<LocalTime> closing_since_;
  LocalTime rate_since_;
  std::uint32_t rate_count_ = 0;
};

}  // namespace hapticast::server
