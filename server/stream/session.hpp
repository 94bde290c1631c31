// SPDX-License-Identifier: MIT
// Protocol state machine of one viewer: hello and welcome, pings, the send queue, deadlines and
// goodbye. A Channel carries its bytes.
// Its coroutines own the session. It never blocks, and its memory is bounded. Thread: io.
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

/// Interface of a session to its owner. Thread: io.
class SessionHost {
 public:
  [[nodiscard]] virtual const Clock& clock() const = 0;
  [[nodiscard]] virtual const MediaClock& mediaClock() const = 0;
  [[nodiscard]] virtual const StreamSettings& settings() const = 0;
  [[nodiscard]] virtual const StreamDescription& description() const = 0;
  /// Returns the reason to refuse this client, nullopt to welcome it.
  [[nodiscard]] virtual std::optional<WireError> refuse(const Hello& hello) const = 0;
  /// Writes the client's datagram parameters to `welcome`, if any.
  virtual void offerDatagrams(const Hosts& hosts, Welcome& welcome) = 0;
  /// Sets how the client with this token wants its frames.
  virtual void deliver(std::uint64_t datagram_token, const Delivery& delivery) = 0;
  /// Called after the session's welcome.
  virtual void onJoined(Session& session) = 0;
  /// Called when the session stops being a viewer's: with a reason if this server closes it,
  /// without one if its peer does. Called at most once.
  virtual void onClosing(const std::shared_ptr<Session>& session,
                         const std::optional<WireError>& why) = 0;
  /// Called at the end of the connection. May be called more than once.
  virtual void onClosed(const std::shared_ptr<Session>& session) = 0;

 protected:
  ~SessionHost() = default;
};

/// One connection. Create it with std::make_shared.
class Session : public std::enable_shared_from_this<Session> {
 public:
  static constexpr std::size_t kMaxPongs = 64;  ///< pings that wait for their pong; chosen
  static constexpr std::uint32_t kMaxMessagesPerSecond = 200;

  /// `io` runs the channel. `host` must outlive the session's coroutines.
  Session(asio::io_context& io, std::unique_ptr<Channel> channel, SessionHost& host,
          std::uint32_t id);

  /// Starts reading and writing.
  void start();
  /// Adds an item to the queue, where newer items may replace it until flush().
  void queue(const EncodedFrame& frame);
  void queue(const EncodedVideo& video);
  void queue(const SharedBytes& control);
  /// Adds a description. `other_picture`: frames and pictures in the queue belong to another
  /// workspace and are removed.
  void queue(const SharedBytes& description, bool other_picture);
  void queue() {}
  /// Sends from the queue what the connection accepts at once, which costs far less than to wake
  /// the writer. The writer sends the rest. Never ends the session.
  void flush();
  /// Combines queue() and flush().
  template <class... What>
  void send(const What&... what) {
    queue(what...);
    flush();
  }
  /// Combines queue() and flush(), but bypasses an empty queue: the usual case.
  void send(const EncodedFrame& frame);
  /// Sends the reason to the peer, then closes. Removes items that still wait.
  void close(const WireError& why);
  /// Closes at once, without a message to the peer.
  void abort();
  /// Checks the deadlines; call regularly.
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
  /// Returns whether the peer has read nothing of a write for longer than write_timeout.
  [[nodiscard]] bool stalled(LocalTime now);
  /// Sends `farewell` as the last message; the host receives `why`.
  void sendGoodbye(const WireError& farewell, const std::optional<WireError>& why);
  void end();
  [[nodiscard]] SharedBytes nextPayload();
  void wakeWriter();

  // With a thousand viewers each session is out of the cache at its turn, so the members of send()
  // are adjacent.
  std::unique_ptr<Channel> channel_;
  bool idle_ = false;  // the writer sleeps, and the queue is empty
  bool frames_on_tcp_ = false;
  SendQueue queue_;
  asio::io_context& io_;
  asio::steady_timer wake_;  // wakes the writer
  SessionHost& host_;
  std::uint32_t id_;
  SharedBytes unfinished_;  // partly written; the writer's next payload
  std::deque<Pong> pongs_;  // t2 is set when the pong is sent
  std::optional<Hello> hello_;
  std::uint64_t datagram_token_ = 0;  // 0: none was offered
  LocalTime started_;
  LocalTime received_;  // time of the last message
  bool ended_ = false;
  bool read_ended_ = false;   // the peer sends nothing more that matters
  bool write_ended_ = false;  // the last message is written
  bool writer_sleeps_ = false;
  bool writing_ = false;
  LocalTime write_progress_;  // last time the peer read bytes
  std::uint64_t bytes_read_ = 0;
  std::optional<LocalTime> closing_since_;
  LocalTime rate_since_;
  std::uint32_t rate_count_ = 0;
};

}  // namespace hapticast::server
