// SPDX-License-Identifier: MIT
// Sends encoded frames to all viewers of a stream. Each viewer has a queue of its own, so that a
// slow viewer never slows another. All queues share the encoded bytes. Thread: the network's,
// except for functions with "Thread: any".
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/limited_sessions.hpp"
#include "server/stream/operator_acts.hpp"
#include "server/stream/session.hpp"
#include "server/stream/stale_frame_filter.hpp"
#include "server/stream/stream_access.hpp"
#include "server/stream/stream_identity.hpp"
#include "server/stream/stream_log.hpp"
#include "server/stream/stream_settings.hpp"
#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

/// Streams of which each belongs to one viewer (--on-demand). Thread: the network's.
class ViewerStreams {
 public:
  virtual ~ViewerStreams() = default;
  /// A client was welcomed.
  virtual void onJoined(const std::shared_ptr<Session>& viewer) = 0;
  /// It is no viewer any more.
  virtual void onLeft(const Session& viewer) = 0;
  /// It requests another pause, place or speed of its stream.
  virtual void onControl(const Session& viewer, const Control& control) = 0;
};

/// Owns the sessions of all viewers of one stream and sends it to them.
class Broadcaster final : public StreamSink, private SessionHost {
 public:
  /// StreamSettings::max_pending with TLS or with the page. It is larger, because a handshake of
  /// TLS or of a WebSocket lasts longer than a hello, and all viewers connect at once after a
  /// restart of the server. Chosen for memory: a connection needs some 50 kB.
  static constexpr std::size_t kMaxPendingHandshakes = 640;
  /// StreamSettings::max_pending without them.
  static constexpr std::size_t kMaxPending = StreamSettings{}.max_pending;

  /// Creates a broadcaster without viewers. `io` runs all its work. One thread runs `io`; it must
  /// end before the Broadcaster's destruction. The clocks must outlive the Broadcaster.
  Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
              StreamDescription description, StreamSettings settings);

  /// Sets the identity of the server that signs all frames. Welcomes contain it. Call it before the
  /// first viewer connects.
  void introduce(const StreamIdentity& identity) { identity_ = identity; }
  /// Enables delivery by UDP through `sender`. Call it before the first viewer connects. `sender`
  /// must outlive all sessions.
  void enableUdp(DatagramSender& sender) { datagrams_ = &sender; }
  /// Requires tokens from now on, and closes the connections whose token `list` does not permit.
  /// Thread: any.
  void setAccess(AccessList list);
  /// Sets a function that the broadcaster calls after it closed connections because their token is
  /// no longer valid. Call it before the first viewer connects. Thread of `removed`: the network's.
  void onRemoved(std::function<void()> removed) { on_removed_ = std::move(removed); }
  /// Function that receives a request of an operator. It calls `confirm` once the request is
  /// carried out, from any thread.
  using OnControl = std::function<void(const Control&, std::function<void()> confirm)>;
  /// Sets the function that receives the requests of operators. Call it before the first viewer
  /// connects. Thread of `control`: the network's.
  void onControl(OnControl control) { control_ = std::move(control); }
  /// Gives each viewer a stream of its own: publish() is not called then. Call it before the first
  /// viewer connects. `streams` must outlive all sessions.
  void serveEach(ViewerStreams& streams) { streams_ = &streams; }
  /// Sends a frame to every viewer, unless it is stale and a newer one follows (StaleFrameFilter).
  /// A viewer that joins later receives the newest frame at once. Thread: any.
  void publish(EncodedFrame frame) override;
  /// Sends a picture to the viewers that subscribed to pictures. Thread: any.
  void publish(EncodedVideo video) override;
  /// Sends `share`, the completed share of the clip's scan (0..1), to all viewers. Viewers that
  /// join before the first frame receive the newest share. Thread: any.
  void prepare(double share);
  /// Sends the description of another stream to all viewers. If the workspace changes, removes all
  /// waiting frames and pictures. Thread: any.
  void describe(const StreamDescription& description) override;
  /// Sends a new key of the sealed datagrams to all viewers to which datagrams were offered.
  /// Thread: any.
  void changeKey(const DatagramKey& key) override;
  /// Changes to another origin, which makes the stream from now on. Removes waiting frames and
  /// pictures. Every viewer receives a second welcome with the stream number, the key, the
  /// description and a new datagram token. Frames that were published before this call belong to
  /// the previous origin, later frames to `identity`. `change_clock` sets the media clock; the
  /// broadcaster calls it when viewers begin to ignore pongs of earlier pings (thread: the
  /// network's). Thread: any.
  void changeOrigin(StreamIdentity identity, const StreamDescription& description,
                    std::function<void()> change_clock = nullptr);
  /// Returns whether at least one viewer subscribed to pictures. Thread: any.
  [[nodiscard]] bool videoWanted() const override {
    return video_viewers_.load(std::memory_order_relaxed) > 0;
  }
  /// Returns whether at least one viewer or the multicast group needs datagrams. Thread: any.
  [[nodiscard]] bool datagramsWanted() const override {
    return datagrams_ != nullptr && datagrams_->wanted();
  }
  /// Returns the number of viewers that were welcomed and are still connected. Thread: any.
  [[nodiscard]] std::size_t viewers() const {
    return viewer_count_.load(std::memory_order_relaxed);
  }
  /// Sends a goodbye to every viewer, and closes all connections within
  /// StreamSettings::goodbye_deadline. After that, `io` has no more work. Thread: any.
  void stop();

  /// Returns the number of connections: viewers, answers to requests of HTTP, and all others.
  [[nodiscard]] std::size_t connections() const {
    return viewers_.size() + pending_.all().size() + answers_.all().size();
  }
  /// Begins a session for the new connection `channel`.
  void accept(std::unique_ptr<Channel> channel);
  /// Logs `line`, unless a limit is reached: 10 warnings a minute, and 10 other lines a minute. So
  /// other hosts cannot fill the log. Returns whether the line was written.
  bool log(spdlog::level::level_enum level, std::string_view line) {
    return log_.log(level, line, clock_.now());
  }
  /// Logs one line with viewers, frames, and the delay of the newest frame since its capture.
  void logStatus() const;
  /// Returns the counts since the broadcaster's creation.
  [[nodiscard]] StreamCounts counts() const;
  [[nodiscard]] const StreamSettings& settings() const override { return settings_; }
  [[nodiscard]] const StreamDescription& description() const override { return description_; }

 private:
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] const MediaClock& mediaClock() const override { return media_clock_; }
  [[nodiscard]] std::optional<WireError> refuse(const Hello& hello,
                                                const Channel& channel) const override;
  [[nodiscard]] std::optional<LocalTime> reserveRefusal(const Session& session,
                                                        LocalTime latest) override {
    return access_.reserveRefusal(session.network(), clock_.now(), latest);
  }
  [[nodiscard]] std::optional<Grant> findGrant(const Hello& hello) const override {
    return access_.findGrant(hello.access_token);
  }
  [[nodiscard]] std::optional<WireError> control(const Control& request,
                                                 const std::shared_ptr<Session>& sender) override;
  /// Returns a request to its sender. An operator also receives the number of viewers.
  void confirm(Session& sender, Control control) const;
  void completeWelcome(const Channel& channel, Welcome& welcome) override;
  void deliver(std::uint64_t datagram_token, const Delivery& delivery) override;
  void onRequest(const std::shared_ptr<Session>& session, const std::string& problem) override;
  void onJoined(Session& session) override;
  void onClosing(const std::shared_ptr<Session>& session,
                 const std::optional<WireError>& why) override;
  void onClosed(const std::shared_ptr<Session>& session) override;

  [[nodiscard]] static WireError serverEnds() {
    return {ErrorCode::kShuttingDown, "the server ends"};
  }
  /// Adds `session` to `list`. If there are too many then, closes one at once. `what`: what the
  /// connections in `list` are, for the log.
  void addWithin(LimitedSessions& list, const std::shared_ptr<Session>& session,
                 std::string_view what);
  /// Calls `visit` later on the network thread. Thread: any.
  template <class Visit>
  void onIo(Visit visit);
  /// Adds `what` to the queue of each viewer, then starts the sending. If calls of onIo() for later
  /// items already wait, only the last of them starts the sending.
  template <class... What>
  void sendAll(const What&... what);
  void send(const EncodedFrame& frame);
  /// Returns whether the frame exceeds the limit of a message; viewers would close the connection
  /// for it. Returns false if the frame only exceeds the limit of datagrams. Viewers then receive
  /// no datagrams and change to TCP a second later. Logs both cases, at most once a minute.
  bool isTooLarge(const EncodedFrame& frame);
  static void check(const Sessions& sessions, LocalTime now);
  asio::awaitable<void> startTimer();
  /// Closes the connections whose token is no longer valid.
  void checkAccess();
  void countViewers();

  asio::io_context& io_;
  const Clock& clock_;
  const MediaClock& media_clock_;
  StreamDescription description_;
  StreamSettings settings_;
  std::optional<StreamIdentity> identity_;  // absent: frames are not signed
  StreamAccess access_;
  std::function<void()> on_removed_;
  OnControl control_;
  OperatorActs acts_;
  ViewerStreams* streams_ = nullptr;
  DatagramSender* datagrams_ = nullptr;
  asio::steady_timer timer_;
  Sessions viewers_;         // welcomed and not closing; in the order in which frames are sent
  LimitedSessions pending_;  // before their hello, or closing
  LimitedSessions answers_;  // to requests of HTTP
  std::uint32_t last_session_id_ = 0;
  SharedBytes preparing_;  // message with the progress of the scan, until the first frame
  std::optional<EncodedFrame> last_frame_;
  std::optional<EncodedVideo> last_video_;
  StaleFrameFilter stale_;
  std::atomic<int> waiting_{0};  // calls of onIo() that have not run
  std::atomic<std::size_t> viewer_count_{0};
  std::atomic<std::size_t> video_viewers_{0};
  bool stopped_ = false;
  StreamCounts counts_;  // its members `clients`, `sent` and `bytes` count viewers that left
  StreamLog log_;
  LocalTime checked_;
  LocalTime counted_;
};

}  // namespace hapticast::server
