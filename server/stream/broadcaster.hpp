// SPDX-License-Identifier: MIT
// Hands encoded frames to all viewers: one queue each, bytes shared, a slow one never slows
// another. Takes bytes, wherever they come from. Thread: io, except where a function says "any".
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>

#include "common/wire/asio.hpp"
#include "common/wire/messages.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/log_limit.hpp"
#include "server/stream/session.hpp"
#include "server/stream/stream_settings.hpp"
#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

class Broadcaster final : public StreamSink, private SessionHost {
 public:
  /// Everything runs on `io`, which one thread runs; that thread ends before the Broadcaster does.
  /// The clocks outlive it.
  Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
              StreamDescription description, StreamSettings settings);

  /// Sends a frame to every viewer; who joins later gets the newest at once. Thread: any.
  void publish(EncodedFrame frame) override;
  /// Sends a picture to those who want it. Thread: any.
  void publish(EncodedVideo video) override;
  /// Announces another stream. A change of the workspace voids the frames before it. Thread: any.
  void describe(const StreamDescription& description) override;
  /// Whether encoding pictures is worth it. Thread: any.
  [[nodiscard]] bool videoWanted() const override {
    return video_viewers_.load(std::memory_order_relaxed) > 0;
  }
  /// How many have been welcomed and have not left. Thread: any.
  [[nodiscard]] std::size_t viewers() const { return viewers_.load(std::memory_order_relaxed); }
  /// Tells every viewer that the server ends and closes them within the goodbye deadline; `io` then
  /// runs out of work. Thread: any.
  void stop();

  /// Takes over a fresh connection.
  void accept(std::unique_ptr<Channel> channel);
  [[nodiscard]] StreamCounts counts() const;
  [[nodiscard]] const StreamSettings& settings() const override { return settings_; }

 private:
  [[nodiscard]] const Clock& clock() const override { return clock_; }
  [[nodiscard]] const MediaClock& mediaClock() const override { return media_clock_; }
  [[nodiscard]] const StreamDescription& description() const override { return description_; }
  [[nodiscard]] std::optional<WireError> refuse(const Hello& hello) const override;
  void joined(Session& session) override;
  void ending(Session& session, const WireError& why) override;
  void left(const std::shared_ptr<Session>& session) override;

  static constexpr std::size_t kStrangers = 32;  // connections that are not (yet) clients
  asio::awaitable<void> watch();
  void summarize(LocalTime now);
  void countViewers();

  asio::io_context& io_;
  const Clock& clock_;
  const MediaClock& media_clock_;
  StreamDescription description_;
  StreamSettings settings_;
  asio::steady_timer timer_;
  std::set<std::shared_ptr<Session>> sessions_;
  std::uint32_t last_session_id_ = 0;
  std::optional<EncodedFrame> last_frame_;
  std::optional<EncodedVideo> last_video_;
  std::atomic<std::size_t> viewers_{0};
  std::atomic<std::size_t> video_viewers_{0};
  bool stopped_ = false;
  StreamCounts counts_;    // clients and sent: of those who left
  SendCounts summarized_;  // what the last summary line has told
  LocalTime last_summary_;
  LogLimit log_limit_;
};

}  // namespace hapticast::server
