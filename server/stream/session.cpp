// SPDX-License-Identifier: MIT
#include "server/stream/session.hpp"

#include <spdlog/spdlog.h>

#include <utility>
#include <vector>

#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

namespace {

constexpr std::size_t kChunkBytes = 16U << 10U;
constexpr std::size_t kMaxDrain = 1U
                                  << 20U;  // bytes of a refused peer that are read and thrown away

std::string nameOf(const asio::ip::tcp::socket& socket) {
  boost::system::error_code ec;
  const auto endpoint = socket.remote_endpoint(ec);
  return ec ? "?" : endpoint.address().to_string() + ":" + std::to_string(endpoint.port());
}

}  // namespace

Session::Session(asio::ip::tcp::socket socket, Broadcaster& broadcaster, std::uint32_t id)
    : socket_(std::move(socket)),
      wake_(socket_.get_executor()),
      broadcaster_(broadcaster),
      id_(id),
      peer_(nameOf(socket_)),
      started_(broadcaster.clock().clock.now()),
      heard_(started_),
      rate_since_(started_) {}

std::string Session::label() const {
  return hello_ && !hello_->client_name.empty() ? peer_ + " (" + hello_->client_name + ")" : peer_;
}

void Session::start() {
  boost::system::error_code ignored;  // both only make things better
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(asio::socket_base::send_buffer_size(broadcaster_.settings().send_buffer_bytes),
                     ignored);
  const auto executor = socket_.get_executor();
  auto self = shared_from_this();
  asio::co_spawn(
      executor, [self] { return self->readAll(); }, asio::detached);
  asio::co_spawn(
      executor, [self] { return self->writeAll(); }, asio::detached);
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

void Session::close(const Error& why) {
  if (closing_since_) return;
  queue_.clear();
  pongs_.clear();
  (void)queue_.pushControl(framed(encode(why)));  // the queue was just emptied
  broadcaster_.ending(*this, why);
  closing_since_ = broadcaster_.clock().clock.now();
  wake_.cancel();
}

void Session::disconnect() {
  boost::system::error_code ignored;
  socket_.close(ignored);
  wake_.cancel();
  broadcaster_.left(shared_from_this());
}

void Session::check(LocalTime now) {
  const StreamSettings& settings = broadcaster_.settings();
  if (closing_since_) {
    if (now - *closing_since_ >= settings.goodbye_deadline) disconnect();
  } else if (write_progress_ && now - *write_progress_ >= settings.write_timeout) {
    broadcaster_.ending(*this, {ErrorCode::kTimeout, "takes nothing off its connection"});
    disconnect();
  } else if (!hello_ && now - started_ >= settings.hello_deadline) {
    close({ErrorCode::kTimeout, "no hello came in time"});
  } else if (now - heard_ >= settings.idle_timeout) {
    close({ErrorCode::kTimeout, "no ping came for too long"});
  }
}

asio::awaitable<void> Session::readAll() {
  std::vector<std::uint8_t> chunk(kChunkBytes);
  FrameReader reader(kMaxSmallMessageBytes);
  for (;;) {
    boost::system::error_code ec;
    const std::size_t size = co_await socket_.async_read_some(
        asio::buffer(chunk), asio::redirect_error(asio::use_awaitable, ec));
    if (ec) {
      disconnect();
      co_return;
    }
    handleChunk(std::span(chunk).first(size), reader);
  }
}

void Session::handleChunk(std::span<const std::uint8_t> chunk, FrameReader& reader) {
  if (!closing_since_) reader.feed(chunk);
  while (!closing_since_) {
    auto message = reader.next();
    if (!message.ok()) return close(message.error());
    if (!message.value()) return;
    if (!withinRate()) return close({ErrorCode::kUnexpected, "too many messages a second"});
    auto content = decode(*message.value());
    if (!content.ok()) return close(content.error());
    heard_ = broadcaster_.clock().clock.now();
    std::visit([this](const auto& each) { handle(each); }, content.value());
  }
  // Closing a socket with unread bytes would reset the connection before the peer has read why.
  drained_bytes_ += chunk.size();
  if (drained_bytes_ > kMaxDrain) disconnect();
}

bool Session::withinRate() {
  const LocalTime now = broadcaster_.clock().clock.now();
  if (now - rate_since_ >= std::chrono::seconds(1)) {
    rate_since_ = now;
    rate_count_ = 0;
  }
  return ++rate_count_ <= kMaxMessagesPerSecond;
}

void Session::handle(const Hello& hello) {
  if (hello_) return close({ErrorCode::kUnexpected, "a second hello"});
  if (const auto refusal = broadcaster_.refuse(hello)) return close(*refusal);
  hello_ = hello;
  const Welcome welcome{kProtocolVersion, id_, 0, broadcaster_.description()};
  (void)queue_.pushControl(framed(encode(welcome)));  // the first message
  broadcaster_.joined(*this);
  wake_.cancel();
}

void Session::handle(const Ping& ping) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a ping before the hello"});
  if (pongs_.size() >= kMaxPongs) return close({ErrorCode::kUnexpected, "too many pings"});
  pongs_.push_back({ping.t0, broadcaster_.clock().now(), {}});
  wake_.cancel();
}

void Session::handle(const Report& report) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a report before the hello"});
  spdlog::debug("{}: {} frames, {} lost, {} late, delay {:.1f} ms", label(), report.frames_received,
                report.frames_lost, report.frames_late, report.playout_delay_ms);
}

template <class Other>
void Session::handle(const Other&) {
  close({ErrorCode::kUnexpected, "a message that only servers send"});
}

SharedBytes Session::nextBytes() {
  if (pongs_.empty()) return queue_.pop();
  Pong pong = pongs_.front();
  pongs_.pop_front();
  pong.t2 = broadcaster_.clock().now();
  return framed(encode(pong));
}

asio::awaitable<void> Session::writeAll() {
  while (socket_.is_open()) {
    if (SharedBytes bytes = nextBytes()) {
      if (!co_await writeBytes(std::move(bytes))) co_return;
      continue;
    }
    boost::system::error_code ec;
    if (closing_since_) {
      socket_.shutdown(asio::socket_base::shutdown_send, ec);
      co_return;
    }
    wake_.expires_at(asio::steady_timer::time_point::max());
    co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

asio::awaitable<bool> Session::writeBytes(SharedBytes bytes) {
  std::size_t written = 0;
  while (written < bytes->size()) {
    write_progress_ = broadcaster_.clock().clock.now();
    boost::system::error_code ec;
    written += co_await socket_.async_write_some(asio::buffer(*bytes) + written,
                                                 asio::redirect_error(asio::use_awaitable, ec));
    if (ec) {
      disconnect();
      co_return false;
    }
  }
  write_progress_.reset();
  co_return true;
}

}  // namespace hapticast::server
