// SPDX-License-Identifier: MIT
#include "server/stream/session.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "common/transport/clock_sync.hpp"
#include "common/wire_limits.hpp"

namespace hapticast::server {

namespace {

// Chosen: more than a client has under way at its refusal. These bytes are read and discarded, so
// that the peer can read the reason.
constexpr std::size_t kMaxDrainBytes = 1U << 20U;

/// Returns the first 64 bits of an IPv6 address, since one host may use all addresses with this
/// prefix. Other addresses are returned unchanged.
std::string findNetwork(const std::string& address) {
  boost::system::error_code ec;
  const auto v6 = asio::ip::make_address_v6(
      address.starts_with('[') ? address.substr(1, address.size() - 2) : address, ec);
  if (ec) return address;
  const auto bytes = v6.to_bytes();
  return {bytes.begin(), bytes.begin() + 8};
}

}  // namespace

Session::Session(asio::io_context& io, std::unique_ptr<Channel> channel, SessionHost& host,
                 std::uint32_t id)
    : channel_(std::move(channel)),
      io_(io),
      wake_(io),
      host_(host),
      id_(id),
      network_(findNetwork(address())),
      started_(host.clock().now()),
      received_(started_),
      write_progress_(started_),
      rate_since_(started_) {}

std::string Session::address() const {
  return channel_->peer().substr(0, channel_->peer().rfind(':'));
}

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

void Session::queue(const EncodedFrame& frame) {
  if (!welcomed() || !frames_on_tcp_) return;
  idle_ = false;
  queue_.pushFrame(frame);
}

void Session::send(const EncodedFrame& frame) {
  if (!idle_ || !frames_on_tcp_ || queue_.sendsPicturesInParts()) {
    queue(frame);
    return flush();
  }
  SharedBytes payload = queue_.pass(frame);
  if (channel_->writeNow(payload, false)) return;
  unfinished_ = std::move(payload);
  wakeWriter();
}

void Session::queue(const EncodedVideo& video) {
  if (!isVideoSubscriber()) return;
  if (!queue_.sendsPicturesInParts() &&
      channel_->estimateDelay(video.payload->size()) > PicturePacer::kMostWait)
    return queue_.dropPicture();
  idle_ = false;
  queue_.pushVideo(video);
}

void Session::queue(const SharedBytes& control) {
  if (!welcomed()) return;
  idle_ = false;
  (void)queue_.pushControl(control);  // a peer that does not read misses it
}

void Session::queue(const SharedBytes& description, bool other_picture) {
  if (!welcomed()) return;
  idle_ = false;
  if (other_picture) queue_.clearFrames();
  queue_.pushDescription(description);
}

void Session::flush() {
  if (!writer_sleeps_) return;  // it reads the queue itself before it sleeps again
  while (!unfinished_) {
    SharedBytes payload = nextPayload();
    idle_ = !payload;
    if (idle_) return;
    if (!channel_->writeNow(payload, payloadWaits())) unfinished_ = std::move(payload);
  }
  wakeWriter();
}

void Session::wakeWriter() {
  writer_sleeps_ = false;
  idle_ = false;
  wake_.cancel();
}

void Session::close(const WireError& why) { sendGoodbye(why, why); }

void Session::sendGoodbye(const WireError& farewell, const std::optional<WireError>& why) {
  if (closing_since_ || ended_) return;
  closing_since_ = host_.clock().now();
  queue_.clear();
  pongs_.clear();
  (void)queue_.pushControl(encodeShared(farewell));  // the queue was just emptied
  wakeWriter();                                      // ends the writing, too
  host_.onClosing(shared_from_this(), why);
}

void Session::end() {
  ended_ = true;
  channel_->close();
  wakeWriter();
  host_.onClosed(shared_from_this());
}

void Session::abort() {
  channel_->abort();
  end();
}

void Session::check(LocalTime now) {
  if (ended_) return;
  const StreamSettings& settings = host_.settings();
  if (answering_since_) {
    checkAnswer(now);
  } else if (closing_since_) {
    if (read_ended_ && write_ended_ && channel_->undeliveredBytes() == 0) {
      end();
    } else if (now - *closing_since_ >= settings.goodbye_deadline) {
      abort();
    }
  } else if (stalled(now)) {
    host_.onClosing(shared_from_this(),
                    WireError{ErrorCode::kTimeout, "reads nothing from its connection"});
    abort();
  } else if (refusal_) {
    if (now >= refusal_time_) close(*refusal_);
  } else if (!hello_ && now - started_ >= settings.hello_deadline) {
    close({ErrorCode::kTimeout, "no hello arrived in time"});
  } else if (!pongs_.empty()) {
    flush();  // no frame has come
  } else if (unconfirmed_ == 0 && now - received_ >= settings.idle_timeout) {
    close({ErrorCode::kTimeout, "no message arrived for too long"});
  }
}

void Session::checkAnswer(LocalTime now) {
  const std::size_t undelivered = channel_->undeliveredBytes();
  if (write_ended_ && undelivered == 0) return end();
  const std::uint64_t delivered = channel_->bytesWritten() - undelivered;
  if (std::exchange(bytes_delivered_, delivered) != delivered) write_progress_ = now;
  const StreamSettings& settings = host_.settings();
  if (now - write_progress_ >= settings.write_timeout ||
      now - *answering_since_ >= settings.answer_deadline)
    abort();
}

bool Session::stalled(LocalTime now) {
  if (!writing_ || channel_->bytesWritten() != bytes_delivered_) {
    bytes_delivered_ = channel_->bytesWritten();
    write_progress_ = now;
  }
  return now - write_progress_ >= host_.settings().write_timeout;
}

asio::awaitable<void> Session::readAll() {
  while (!refusal_ && !closing_since_ && !ended_) {
    const auto payload = co_await channel_->read();
    if (closing_since_ || ended_) break;  // a payload read by then is too late
    if (!payload.ok()) {
      close(payload.error());
    } else if (payload.value()) {
      onPayload(*payload.value());
    } else if (channel_->carrier() == Carrier::kHttp) {
      co_return co_await answerRequest();
    } else {
      // A peer that only ends its own side may still read; the host receives no reason.
      sendGoodbye({ErrorCode::kUnexpected, "you ended your side of the connection"}, std::nullopt);
      read_ended_ = true;
      co_return;
    }
  }
  co_await channel_->drain(kMaxDrainBytes);
  read_ended_ = true;
}

asio::awaitable<void> Session::answerRequest() {
  answering_since_ = write_progress_ = host_.clock().now();
  host_.onRequest(shared_from_this(), channel_->problem());
  co_await channel_->answer();
  write_ended_ = true;
  co_await channel_->drain(kMaxDrainBytes);
  if (!ended_) end();
}

void Session::onPayload(Payload payload) {
  if (!isWithinRate()) return close({ErrorCode::kUnexpected, "too many messages a second"});
  const auto message = decode(payload);
  if (!message.ok()) return close(message.error());
  received_ = host_.clock().now();
  std::visit([this](const auto& each) { handle(each); }, message.value());
}

bool Session::isWithinRate() {
  const LocalTime now = host_.clock().now();
  if (now - rate_since_ >= std::chrono::seconds(1)) {
    rate_since_ = now;
    rate_count_ = 0;
  }
  return ++rate_count_ <= kMaxMessagesPerSecond;
}

void Session::handle(const Hello& hello) {
  if (hello_) return close({ErrorCode::kUnexpected, "a second hello"});
  if (const auto refusal = host_.refuse(hello, *channel_)) return refuse(*refusal);
  grant_ = host_.findGrant(hello);
  hello_ = hello;
  hello_->access_token.clear();
  if (hello.accepts_picture_parts) queue_.sendPicturesInParts();
  queueWelcome();
  host_.onJoined(*this);
  flush();
}

void Session::refuse(const WireError& why) {
  if (why.code != ErrorCode::kUnauthorized) return close(why);
  const auto time = host_.reserveRefusal(*this, started_ + host_.settings().hello_deadline);
  if (!time) {
    host_.onClosing(shared_from_this(), why);
    return abort();
  }
  refusal_ = why;
  refusal_time_ = *time;
  check(host_.clock().now());  // the first answer needs no wait
}

void Session::queueWelcome() {
  frames_on_tcp_ = hello_->wants_frames_on_tcp;
  wants_pictures_ = hello_->wants_video;
  Welcome welcome{kProtocolVersion, id_, 0, host_.description()};
  host_.completeWelcome(*channel_, welcome);
  datagram_token_ = welcome.datagram_token;
  quick_pongs_ = 0;
  idle_ = false;
  (void)queue_.pushControl(encodeShared(welcome));  // an empty queue has room
}

void Session::welcomeAgain() {
  // A payload that is written in part comes whole before the welcome, nothing else does. If the
  // first welcome still waits, the client receives only the second one.
  queue_.clear();
  pongs_.clear();  // their pings arrived by the clock of the server before
  queueWelcome();
  flush();
}

void Session::handle(const Ping& ping) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a ping before the hello"});
  if (pongs_.size() >= kMaxPongs) return close({ErrorCode::kUnexpected, "too many pings"});
  idle_ = false;
  pongs_.push_back({ping.t0, host_.mediaClock().now(), {}, {}});
  // Later pongs leave with the next frame, which saves a send for each. Their times t1 and t2 show
  // that they have waited.
  if (frames_on_tcp_ && quick_pongs_ >= ClockSync::kBurst) return;
  ++quick_pongs_;
  flush();
}

void Session::handle(const Delivery& delivery) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a delivery before the hello"});
  // Waiting frames are stale by then, and losses in the meantime are unknown, so the next frame is
  // a key frame.
  if (delivery.on_tcp != frames_on_tcp_) queue_.clearFrames();
  frames_on_tcp_ = delivery.on_tcp;
  wants_pictures_ = delivery.pictures.value_or(wants_pictures_);
  if (!wants_pictures_) queue_.clearPictures();
  host_.deliver(datagram_token_, delivery);
}

void Session::handle(const ReceiverReport& report) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a report before the hello"});
  spdlog::debug("{}: {} frames, {} lost, {} late, delay {:.1f} ms", label(), report.frames_received,
                report.frames_lost, report.frames_late, report.playout_delay_ms);
}

void Session::handle(const Control& control) {
  if (!hello_) return close({ErrorCode::kUnexpected, "a request before the hello"});
  if (unconfirmed_ >= kMaxUnconfirmed)
    return close({ErrorCode::kUnexpected, "too many requests wait for the server"});
  ++unconfirmed_;
  if (const auto refusal = host_.control(control, shared_from_this())) close(*refusal);
}

void Session::confirm(const Control& control) {
  --unconfirmed_;
  received_ = host_.clock().now();  // the client may have waited for a long seek
  send(encodeShared(control));
}

void Session::handle(const Receipt& receipt) {
  if (!hello_ || !queue_.sendsPicturesInParts())
    return close({ErrorCode::kUnexpected, "a receipt of a client that accepts no parts"});
  queue_.onReceipt(receipt, host_.clock().now());
  flush();  // a part may leave now
}

template <class Other>
void Session::handle(const Other&) {
  close({ErrorCode::kUnexpected, "a message that only servers send"});
}

SharedBytes Session::nextPayload() {
  const LocalTime now = host_.clock().now();
  SharedBytes payload = pongs_.empty() || queue_.controlWaits() ? queue_.pop(now) : popPong();
  if (payload) queue_.countSent(payload->size(), now);
  return payload;
}

SharedBytes Session::popPong() {
  Pong pong = pongs_.front();
  pongs_.pop_front();
  pong.t2 = host_.mediaClock().now();
  pong.error =
      std::clamp(host_.mediaClock().errorBound(), Duration{}, Duration(limits::kClockError_ns));
  return encodeShared(pong);
}

asio::awaitable<void> Session::writeAll() {
  while (!ended_) {
    if (SharedBytes payload = unfinished_ ? std::exchange(unfinished_, nullptr) : nextPayload()) {
      writing_ = true;
      const bool written = co_await channel_->write(std::move(payload));
      writing_ = false;
      if (written) continue;
      if (!closing_since_ && !ended_) host_.onClosing(shared_from_this(), std::nullopt);
      end();
      co_return;
    }
    if (closing_since_) {
      co_await channel_->finishWriting();
      write_ended_ = true;
      co_return;
    }
    boost::system::error_code ec;
    wake_.expires_at(asio::steady_timer::time_point::max());
    writer_sleeps_ = idle_ = true;
    co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

}  // namespace hapticast::server
