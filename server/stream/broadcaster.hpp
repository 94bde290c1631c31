// SPDX-License-Identifier: MIT
// Fan-out of encoded frames to all viewers: one queue for each viewer, shared bytes, so that a slow
// viewer never slows another. Thread: io, except where a function says "any".
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/log_rate_limiter.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/datagram_sender.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/session.hpp"
#include "server/stream/stream_settings.hpp"
#include "server/stream/stream_sink.hpp"

namespace spdlog::level {
enum level_enum : int;  // NOLINT(readability-identifier-naming): the name of spdlog
}

namespace hapticast::server {

/// All viewers of one stream.
class Broadcaster final : public StreamSink, private SessionHost {
 public:
  /// Limit of pending connections: those before their hello, and those that are closing. Chosen:
  /// more than a healthy stream ever has.
  static constexpr std::size_t kMaxPending = 32;

  /// Uses `io` for all its work. One thread runs `io` and ends before the Broadcaster's
  /// destruction. The clocks must outlive the Broadcaster.
  Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
              StreamDescription description, StreamSettings settings);

  /// Enables UDP delivery. Call before the first viewer connects; `sender` must outlive all
  /// sessions.
  void enableUdp(DatagramSender& sender) { datagrams_ = &sender; }
  /// Sends a frame to every viewer; later viewers receive the newest frame at once. Thread: any.
  void publish(EncodedFrame frame) override;
  /// Sends a picture to the viewers that subscribed to pictures. Thread: any.
  void publish(EncodedVideo video) override;
  /// Reports the progress of the clip's scan, 0..1, to present viewers and to viewers that join
  /// before the first frame. Thread: any.
  void prepare(double share);
  /// Announces another stream. A new workspace invalidates earlier frames. Thread: any.
  void describe(const StreamDescription& description) override;
  /// Returns whether a viewer subscribed to pictures. Thread: any.
  [[nodiscard]] bool videoWanted() const override {
    return video_viewers_.load(std::memory_order_relaxed) > 0;
  }
  /// Returns whether a viewer or the group needs datagrams. Thread: any.
  [[nodiscard]] bool datagramsWanted() const override {
    return datagrams_ != nullptr && datagrams_->wanted();
  }
  /// Returns the number of welcomed and present viewers. Thread: any.
  [[nodiscard]] std::size_t viewers() const {
    return viewer_count_.load(std::memory_order_relaxed);
  }
  /// Sends a goodbye to every viewer and closes all connections within the goodbye deadline. `io`
  /// then runs out of work. Thread: any.
  void stop();

  /// Starts a session for a new connection.
  void accept(std::unique_ptr<Channel> channel);
  /// Logs a line, rate-limited: at most 20 lines a minute, half of them warnings, whatever hosts on
  /// the port do. Returns whether the line was written.
  bool log(spdlog::level::level_enum level, std::string_view line);
  /// Returns the counts since the start.
  [[nodiscard]] StreamCounts counts() const;
  [[nodiscard]] const StreamSettings& settings() const override { return settings_; }

 private:
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] const MediaClock& mediaClock() const override { return media_clock_; }
  [[nodiscard]] const StreamDescription& description() const override { return description_; }
  [[nodiscard]] std::optional<WireError> refuse(const Hello& hello) const override;
  void offerDatagrams(const Hosts& hosts, Welcome& welcome) override;
  void deliver(std::uint64_t datagram_token, const Delivery& delivery) override;
  void onJoined(Session& session) override;
  void onClosing(const std::shared_ptr<Session>& session,
                 const std::optional<WireError>& why) override;
  void onClosed(const std::shared_ptr<Session>& session) override;

  using Sessions = std::vector<std::shared_ptr<Session>>;
  /// Adds the session to the pending connections: it is not a viewer yet, or not any more. Above
  /// kMaxPending it aborts the evictionCandidate().
  void addStranger(const std::shared_ptr<Session>& session);
  /// Returns the oldest pending session of the network with most pending sessions, so that a single
  /// host cannot occupy all places.
  [[nodiscard]] std::shared_ptr<Session> evictionCandidate() const;
  /// Posts `visit` to io. Thread: any.
  template <class Visit>
  void onIo(Visit visit);
  /// Sends `what` to each viewer; only queues it if newer items wait.
  template <class... What>
  void sendAll(const What&... what);
  /// Returns whether the frame exceeds the message limit, so that viewers would close the
  /// connection. Logs once a minute, also if only its datagrams are too large. Viewers without
  /// datagrams change to TCP a second later.
  bool tooLarge(const EncodedFrame& frame);
  static void check(const Sessions& sessions, LocalTime now);
  asio::awaitable<void> startTimer();
  void logSlowViewers(LocalTime now);
  void logDatagrams(LocalTime now);
  /// Logs the number of suppressed lines if no later line reported it.
  void logHidden();
  void countViewers();

  asio::io_context& io_;
  const Clock& clock_;
  const MediaClock& media_clock_;
  StreamDescription description_;
  StreamSettings settings_;
  DatagramSender* datagrams_ = nullptr;
  asio::steady_timer timer_;
  Sessions viewers_;           // welcomed and not closing; in order of service
  Sessions pending_sessions_;  // before the hello, or closing; the oldest first
  std::uint32_t last_session_id_ = 0;
  SharedBytes preparing_;  // scan progress, until the first frame
  std::optional<EncodedFrame> last_frame_;
  std::optional<EncodedVideo> last_video_;
  std::atomic<int> waiting_{0};  // posted calls that have not run
  std::atomic<std::size_t> viewer_count_{0};
  std::atomic<std::size_t> video_viewers_{0};
  bool stopped_ = false;
  StreamCounts counts_;  // clients and sent: of viewers that left
  SendCounts logged_;    // last logged counts of slow viewers
  LocalTime checked_;
  LocalTime counted_;
  DatagramSenderCounts logged_datagrams_;
  LogInterval slow_interval_;
  LogInterval large_interval_;
  LogInterval datagrams_interval_;
  LogRateLimiter comings_and_goings_;  // separate, so that a crowd does not hide problems
  LogRateLimiter problems_;
};

}  // namespace hapticast::server
