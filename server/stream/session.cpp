// SPDX-License-Identifier: MIT
#include "server/stream/session.hpp"

#include <spdlog/spdlog.h>

#include <utility>
#include <vector>

namespace hapticast::server {

namespace {

// Chosen: more than any client has under way when it is refused. It is read and thrown away, so
// that the peer can read why it was refused.
constexpr std::size_t kMaxDrainBytes = 1U << 20U;

}  // namespace

Session::Session(asio::io_context& io, std::unique_ptr<Channel> channel, SessionHost& host,
                 std::uint32_t id)
    : io_(io),
      channel_(std::move(channel)),
      wake_(io),
      host_(host),
      id_(id),
      started_(host.clock().now()),
      heard_(started_),
      write_progress_(started_),
      rate_since_(started_) {}

std::string Session::label() const {
  const std::string& peer = channel_->peer();
  return hello_ && !hello_->client_name.empty() ? peer + " (" + hello_->client_name + ")" : peer;
}

void Session::start() {
  auto self = shared_from_this();
  asio::co_spawn(
      io_, [self] { return self->readAll(); }, asio::detached);
  asio::co_spawn(
      io_, [self] { return self->writeAll(); }, asio::detached);
}

void Session::send(const EncodedFrame& frame) {
  if (!welcomed() || !hello_->wants_frames_on_tcp) return;
  queue_.pushFrame(frame);
  wake_.cancel();
}

void Session::send(const EncodedVideo& video) {
  if (!wantsVideo()) return;
  queue_.pushVideo(video);
  wake_.cancel();
}

void Session::describe(const SharedBytes& description, bool other_picture) {
  if (!welcomed()) return;
  if (other_picture) queue_.clearFrames();
  queue_.pushDescription(description);
  wake_.cancel();
}

void Session::close(const WireError& why) {
  if (closing_since_) return;
  queue_.clear();
  pongs_.clear();
  (void)queue_.pushControl(encodeShared(why));  // the queue was just emptied
  host_.ending(*this, why);
  closing_since_ = host_.clock().now();
  wake_.cancel();
}

void Session::disconnect() {
  disconnected_ = true;
  channel_->close();
  wake_.cancel();
  host_.left(shared_from_this());
}

void Session::check(LocalTime now) {
  const StreamSettings& settings = host_.settings();
  if (closing_since_) {
    if (now - *closing_since_ >= settings.goodbye_deadline) disconnect();
  } else if (stalled(now)) {
    host_.ending(*this, {ErrorCode::kTimeout, "takes nothing off its connection"});
    disconnect();
  } else if (!hello_ && now - started_ >= settings.hello_deadline) {
    close({ErrorCode::kTimeout, "no hello came in time"});
  } else if (now - heard_ >= settings.idle_timeout) {
    close({ErrorCode::kTimeout, "no message came for too long"});
  }
}

bool Session::stalled(LocalTime now) {
  if (!writing_ || channel_->bytesWritten() != bytes_taken_) {
    bytes_taken_ = channel_->bytesWritten();
    write_progress_ = now;
  }
  return now - write_progress_ >= host_.settings().write_timeout;
}

asio::awaitable<void> Session::readAll() {
  while (!closing_since_) {
    const auto payload = co_await channel_->read();
    if (closing_since_) break;
    if (!payload.ok()) {
      close(payload.error());
    } else if (payload.value()) {
      take(*payload.value());
    } else {
      disconnect();
      co_return;
    }
  }
  co_await channel_->drain(kMaxDrainBytes);
  disconnect();
}

void Session::take(Payload payload) {
  if (!withinRate()) return close({ErrorCode::kUnexpected, "too many messages a second"});
  const auto message = decode(payload);
  if (!message.ok()) return close(message.error());
  heard_ = host_.clock().now();
  std::visit([this](const auto& each) { handle(each); }, message.value());
}

bool Session::withinRate() {
  const LocalTime now = host_.clock().now();
  if (now - rate_since_ >= std::chrono::seconds(1)) {
    rate_since_ = now;
    rate_count_ = 0;
  }
  return ++rate_count_ <= kMaxMessagesPerSecond;
}

void Session::handle(const Hello& hello) {
  if (hello_) return close({ErrorCode::kUnexpected, "a second hello"});
  if (const auto refusal = host_.refuse(hello)) return close(*refusal);
  hello_ = hello;
  const Welcome welcome{kProtocolVersion, id_, 0, host_.description()};
  (void)queue_.pushControl(encodeShared(welcome));  // the first message
  host_.joined(*this);
  wake_.cancel();
}

void Session::handle(const Ping& ping) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a ping before the hello"});
  if (pongs_.size() >= kMaxPongs) return close({ErrorCode::kUnexpected, "too many pings"});
  pongs_.push_back({ping.t0, host_.mediaClock().now(), {}});
  wake_.cancel();
}

void Session::handle(const ReceiverReport& report) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a report before the hello"});
  spdlog::debug("{}: {} frames, {} lost, {} late, delay {:.1f} ms", label(), report.frames_received,
                report.frames_lost, report.frames_late, report.playout_delay_ms);
}

template <class Other>
void Session::handle(const Other&) {
  close({ErrorCode::kUnexpected, "a message that only servers send"});
}

SharedBytes Session::nextPayload() {
  if (pongs_.empty()) return queue_.pop();
  Pong pong = pongs_.front();
  pongs_.pop_front();
  pong.t2 = host_.mediaClock().now();
  return encodeShared(pong);
}

asio::awaitable<void> Session::writeAll() {
  while (!disconnected_) {
    if (SharedBytes payload = nextPayload()) {
      writing_ = true;
      const bool written = co_await channel_->write(std::move(payload));
      writing_ = false;
      if (written) continue;
      disconnect();
      co_return;
    }
    if (closing_since_) {
      channel_->finishWriting();
      co_return;
    }
    boost::system::error_code ec;
    wake_.expires_at(asio::steady_timer::time_point::max());
    co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

}  // namespace hapticast::server
