// SPDX-License-Identifier: MIT
// Hands encoded frames to all viewers: one queue each, bytes shared, a slow one never slows
// another. Takes bytes, wherever they come from. Thread: io, except where a function says "any".
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

class Broadcaster final : public StreamSink, private SessionHost {
 public:
  /// Connections beside the viewers' that are kept at a time: those that have not said hello yet,
  /// and those that are being closed. Chosen: more than a healthy stream ever has.
  static constexpr std::size_t kMaxPending = 32;

  /// Everything runs on `io`, which one thread runs; that thread ends before the Broadcaster does.
  /// The clocks outlive it.
  Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
              StreamDescription description, StreamSettings settings);

  /// Offers viewers to send their frames as datagrams as well. Before the first of them comes;
  /// `sender` outlives the connections.
  void enableUdp(DatagramSender& sender) { datagrams_ = &sender; }
  /// Sends a frame to every viewer; who joins later gets the newest at once. Thread: any.
  void publish(EncodedFrame frame) override;
  /// Sends a picture to those who want it. Thread: any.
  void publish(EncodedVideo video) override;
  /// Tells viewers and who joins before the first frame how much of the clip is looked through.
  /// Thread: any.
  void prepare(double share);
  /// Announces another stream. A change of the workspace voids the frames before it. Thread: any.
  void describe(const StreamDescription& description) override;
  /// Whether encoding pictures is worth it. Thread: any.
  [[nodiscard]] bool videoWanted() const override {
    return video_viewers_.load(std::memory_order_relaxed) > 0;
  }
  [[nodiscard]] bool datagramsWanted() const override {
    return datagrams_ != nullptr && datagrams_->wanted();
  }
  /// How many have been welcomed and have not left. Thread: any.
  [[nodiscard]] std::size_t viewers() const {
    return viewer_count_.load(std::memory_order_relaxed);
  }
  /// Tells every viewer that the server ends and closes them within the goodbye deadline; `io` then
  /// runs out of work. Thread: any.
  void stop();

  /// Takes over a fresh connection.
  void accept(std::unique_ptr<Channel> channel);
  /// Writes a line to the log unless there were too many of late: whatever strangers on the port
  /// do, there are at most 20 a minute, half of them warnings.
  /// Returns whether it was written.
  bool log(spdlog::level::level_enum level, std::string_view line);
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
  /// The session's connection does not count as a viewer's (yet, or any more). Above kMaxPending
  /// of them one has to go.
  void addStranger(const std::shared_ptr<Session>& session);
  /// The oldest stranger from the address that most of them come from: so that a single host
  /// cannot take everybody's places.
  [[nodiscard]] std::shared_ptr<Session> evictionCandidate() const;
  /// Calls `visit` on io when its turn comes. Thread: any.
  template <class Visit>
  void onIo(Visit visit);
  /// Sends something to each viewer, or, where something newer waits, only puts it into its queue.
  template <class... What>
  void sendAll(const What&... what);
  /// Whether viewers would refuse the frame and the connection with it; says so once a minute, and
  /// where only its datagrams are left out: whom none reach takes frames by TCP a second later.
  bool tooLarge(const EncodedFrame& frame);
  static void check(const Sessions& sessions, LocalTime now);
  asio::awaitable<void> startTimer();
  void logSlowViewers(LocalTime now);
  void logDatagrams(LocalTime now);
  /// How many lines were kept back, where nothing more has come to say it with.
  void logHidden();
  void countViewers();

  asio::io_context& io_;
  const Clock& clock_;
  const MediaClock& media_clock_;
  StreamDescription description_;
  StreamSettings settings_;
  DatagramSender* datagrams_ = nullptr;
  asio::steady_timer timer_;
  Sessions viewers_;           // welcomed and not closing; the one that is served first comes first
  Sessions pending_sessions_;  // no hello yet, or closing; the oldest first
  std::uint32_t last_session_id_ = 0;
  SharedBytes preparing_;  // until the first frame
  std::optional<EncodedFrame> last_frame_;
  std::optional<EncodedVideo> last_video_;
  std::atomic<int> waiting_{0};  // calls by onIo() whose turn has not come
  std::atomic<std::size_t> viewer_count_{0};
  std::atomic<std::size_t> video_viewers_{0};
  bool stopped_ = false;
  StreamCounts counts_;  // clients and sent: of those who left
  SendCounts logged_;    // of slow viewers
  LocalTime checked_;
  LocalTime counted_;
  DatagramSenderCounts logged_datagrams_;
  LogInterval slow_interval_;
  LogInterval large_interval_;
  LogInterval datagrams_interval_;
  LogRateLimiter comings_and_goings_;  // apart, so that a crowd does not hide problems
  LogRateLimiter problems_;
};

}  // namespace hapticast::server
