// SPDX-License-Identifier: MIT
#include "server/stream/broadcaster.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace hapticast::server {

namespace {
constexpr auto kCheckEvery = std::chrono::milliseconds(50);
constexpr auto kSummaryEvery = std::chrono::seconds(1);
}  // namespace

Broadcaster::Broadcaster(asio::io_context& io, const Clock& clock, const MediaClock& media_clock,
                         StreamDescription description, StreamSettings settings)
    : io_(io),
      clock_(clock),
      media_clock_(media_clock),
      description_(std::move(description)),
      settings_(settings),
      timer_(io),
      last_summary_(clock.now()) {
  asio::co_spawn(
      io_, [this] { return watch(); }, asio::detached);
}

void Broadcaster::publish(EncodedFrame frame) {
  asio::post(io_, [this, frame = std::move(frame)] {
    last_frame_ = frame;
    for (const auto& session : sessions_) session->send(frame);
  });
}

void Broadcaster::publish(EncodedVideo video) {
  asio::post(io_, [this, video = std::move(video)] {
    last_video_ = video;
    for (const auto& session : sessions_) session->send(video);
  });
}

void Broadcaster::describe(const StreamDescription& description) {
  asio::post(io_, [this, description] {
    if (description == description_) return;
    const bool other_picture = !(description.workspace == description_.workspace);
    description_ = description;
    if (other_picture) {
      last_frame_.reset();
      last_video_.reset();
    }
    const SharedBytes payload = encodeShared(description_);
    for (const auto& session : sessions_) session->describe(payload, other_picture);
  });
}

void Broadcaster::stop() {
  asio::post(io_, [this] {
    stopped_ = true;
    for (const auto& session : sessions_) {
      session->close({ErrorCode::kShuttingDown, "the server ends"});
    }
    timer_.cancel();
  });
}

void Broadcaster::accept(std::unique_ptr<Channel> channel) {
  if (sessions_.size() >= settings_.max_clients + kStrangers) {
    ++counts_.refused;
    return;  // which closes it
  }
  auto session = std::make_shared<Session>(io_, std::move(channel),
                                           static_cast<SessionHost&>(*this), ++last_session_id_);
  sessions_.insert(session);
  session->start();
  if (stopped_) session->close({ErrorCode::kShuttingDown, "the server ends"});
}

std::optional<WireError> Broadcaster::refuse(const Hello& hello) const {
  if (hello.protocol_version != kProtocolVersion) {
    return WireError{ErrorCode::kVersion, "this server speaks protocol version " +
                                              std::to_string(kProtocolVersion) + ", the client " +
                                              std::to_string(hello.protocol_version)};
  }
  const auto clients = static_cast<std::size_t>(std::count_if(
      sessions_.begin(), sessions_.end(), [](const auto& each) { return each->welcomed(); }));
  if (clients < settings_.max_clients) return std::nullopt;
  return WireError{ErrorCode::kServerFull,
                   "all " + std::to_string(settings_.max_clients) + " places are taken"};
}

void Broadcaster::joined(Session& session) {
  ++counts_.welcomed;
  countViewers();
  if (last_frame_) session.send(*last_frame_);
  if (last_video_) session.send(*last_video_);
  spdlog::info("{} joined", session.label());
}

void Broadcaster::ending(Session& session, const WireError& why) {
  if (why.code == ErrorCode::kShuttingDown) return;
  ++(why.code == ErrorCode::kTimeout ? counts_.timed_out : counts_.refused);
  if (!log_limit_.allow(clock_.now())) return;
  const std::uint64_t hidden = log_limit_.takeSuppressed();
  spdlog::warn("closing {}: {}{}", session.label(), why.message,
               hidden > 0 ? " (and " + std::to_string(hidden) + " others, not shown)" : "");
}

void Broadcaster::left(const std::shared_ptr<Session>& session) {
  if (sessions_.erase(session) == 0) return;
  counts_.sent += session->counts();
  countViewers();
  if (session->welcomed()) spdlog::info("{} left", session->label());
  if (stopped_ && sessions_.empty()) timer_.cancel();
}

void Broadcaster::countViewers() {
  const auto count = [this](bool (Session::*is)() const) {
    return static_cast<std::size_t>(std::count_if(
        sessions_.begin(), sessions_.end(), [is](const auto& each) { return (*each.*is)(); }));
  };
  viewers_.store(count(&Session::welcomed), std::memory_order_relaxed);
  video_viewers_.store(count(&Session::wantsVideo), std::memory_order_relaxed);
}

StreamCounts Broadcaster::counts() const {
  StreamCounts counts = counts_;
  for (const auto& session : sessions_) {
    counts.clients += session->welcomed() ? 1 : 0;
    counts.sent += session->counts();
  }
  return counts;
}

asio::awaitable<void> Broadcaster::watch() {
  while (!stopped_ || !sessions_.empty()) {
    boost::system::error_code ec;
    timer_.expires_after(kCheckEvery);
    co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    const LocalTime now = clock_.now();
    // A check may end a session and take it out of the set.
    const std::vector<std::shared_ptr<Session>> sessions(sessions_.begin(), sessions_.end());
    for (const auto& session : sessions) session->check(now);
    if (now - last_summary_ >= kSummaryEvery) summarize(now);
  }
}

void Broadcaster::summarize(LocalTime now) {
  last_summary_ = now;
  const StreamCounts all = counts();
  if (all.sent.dropped() > summarized_.dropped()) {
    spdlog::warn(
        "slow viewers: dropped {} frames (newer ones came), {} (too old), {} pictures; {} clients",
        all.sent.frames_dropped_full - summarized_.frames_dropped_full,
        all.sent.frames_dropped_old - summarized_.frames_dropped_old,
        all.sent.videos_dropped - summarized_.videos_dropped, all.clients);
  }
  summarized_ = all.sent;
}

}  // namespace hapticast::server
