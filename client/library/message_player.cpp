// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "client/include/hapticast/stream.hpp"
#include "client/library/renderer_impl.hpp"
#include "client/net/decode_thread.hpp"
#include "client/net/message_receiver.hpp"

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
    const auto message = messages_.receive(bytes, clock_.now());
    prepare();
    if (!message.ok()) throw std::runtime_error(message.error().message);
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
  CallerClock clock_;
  std::shared_ptr<FrameFeed> feed_ = std::make_shared<FrameFeed>();
  client::DecodeThread decode_thread_;
  client::Receiver receiver_;
  client::MessageReceiver messages_{receiver_};
};

MessagePlayer::MessagePlayer(Renderer& renderer) : impl_(std::make_unique<Impl>(*renderer.impl_)) {}

MessagePlayer::~MessagePlayer() = default;

void MessagePlayer::push(std::span<const std::uint8_t> message, double arrival_s) {
  impl_->push(message, arrival_s);
}

void MessagePlayer::release(double time_s) { impl_->release(time_s); }

}  // namespace hapticast
