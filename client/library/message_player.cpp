// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "client/include/hapticast/stream.hpp"
#include "client/library/renderer_impl.hpp"
#include "client/net/receiver.hpp"
#include "client/net/welcome_limiter.hpp"
#include "common/protocol/messages.hpp"
#include "common/protocol/signed_frame.hpp"

namespace hapticast {

namespace {

/// The caller's time.
class CallerClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override { return now_; }
  /// Sets the time to `time_s`, unless it would go back.
  void advanceTo(double time_s) {
    if (!(std::abs(time_s) <= 9e8))
      throw std::invalid_argument("time: " + std::to_string(time_s) + " s is outside +-9e8 s");
    now_ = std::max(now_, LocalTime(Duration(std::llround(1e9 * time_s))));
  }

 private:
  LocalTime now_{LocalTime::min()};
};

}  // namespace

class MessagePlayer::Impl {
 public:
  explicit Impl(Renderer::Impl& renderer)
      : decode_thread_(
            feed_->pool, clock_, renderer.method(),
            [this](const client::PreparedFrame& frame) { receiver_.addPrepared(frame); }),
        receiver_(decode_thread_, feed_->timing, renderer.method() == Method::kThesis ? 2 : 1) {
    renderer.attach(feed_);
  }

  void push(std::span<const std::uint8_t> bytes, double arrival_s) {
    clock_.advanceTo(arrival_s);
    auto message = decode(bytes);
    auto error = message.ok() ? receive(std::move(message).value(), bytes) : message.error();
    prepare();
    if (!error) return;
    welcomed_ = false;
    receiver_.disconnected(clock_.now());
    throw std::runtime_error(error->message);
  }
  void release(double time_s) {
    clock_.advanceTo(time_s);
    receiver_.release(clock_.now());
    prepare();
  }

 private:
  void prepare() {
    while (!decode_thread_.holdsBack() && decode_thread_.step()) {
    }
  }
  std::optional<WireError> receive(Message message, std::span<const std::uint8_t> bytes);
  std::optional<WireError> receive(const Welcome& welcome);

  CallerClock clock_;
  std::shared_ptr<FrameFeed> feed_ = std::make_shared<FrameFeed>();
  client::DecodeThread decode_thread_;
  client::Receiver receiver_;
  bool welcomed_ = false;
  RateLimiter welcomes_ = client::makeWelcomeLimiter();
  std::optional<VerifyingKey> key_;  // absent: the server signs nothing
  std::uint32_t stream_ = 0;
};

std::optional<WireError> MessagePlayer::Impl::receive(const Welcome& welcome) {
  if (welcome.protocol_version != kProtocolVersion)
    return WireError{ErrorCode::kVersion, "the messages are of protocol version " +
                                              std::to_string(welcome.protocol_version) +
                                              ", not of " + std::to_string(kProtocolVersion)};
  if (!welcomed_) {
    welcomes_ = client::makeWelcomeLimiter();
  } else if (welcomes_.allow(clock_.now())) {
    receiver_.disconnected(clock_.now());
  } else {
    return WireError{ErrorCode::kUnexpected, "the server changes its origin too often"};
  }
  key_.reset();
  if (welcome.verifying_key) {
    auto key = VerifyingKey::from(*welcome.verifying_key);
    if (!key.ok()) return WireError{ErrorCode::kMalformed, "the server's key is not valid"};
    key_ = std::move(key).value();
  }
  stream_ = welcome.stream;
  welcomed_ = true;
  receiver_.connected(welcome.description, clock_.now());
  return std::nullopt;
}

std::optional<WireError> MessagePlayer::Impl::receive(Message message,
                                                      std::span<const std::uint8_t> bytes) {
  if (auto* const error = std::get_if<WireError>(&message)) return std::move(*error);
  if (const auto* const welcome = std::get_if<Welcome>(&message)) return receive(*welcome);
  if (!welcomed_) return WireError{ErrorCode::kUnexpected, "the first message is not a welcome"};
  if (auto* const frame = std::get_if<CodedFrame>(&message)) {
    if (key_ && !verifyFrame(bytes, stream_, *key_))
      return WireError{ErrorCode::kMalformed, "a frame has no valid signature"};
    receiver_.frame(std::move(*frame), clock_.now());
  } else if (const auto* const pong = std::get_if<Pong>(&message)) {
    receiver_.pong(*pong, clock_.now());
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    receiver_.describe(*description, clock_.now());
  }
  return std::nullopt;  // the others change no force
}

MessagePlayer::MessagePlayer(Renderer& renderer) : impl_(std::make_unique<Impl>(*renderer.impl_)) {}

MessagePlayer::~MessagePlayer() = default;

void MessagePlayer::push(std::span<const std::uint8_t> message, double arrival_s) {
  impl_->push(message, arrival_s);
}

void MessagePlayer::release(double time_s) { impl_->release(time_s); }

}  // namespace hapticast
