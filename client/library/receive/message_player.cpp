// SPDX-License-Identifier: MIT
#include <cmath>
#include <stdexcept>
#include <utility>

#include "client/include/hapticast/stream.hpp"
#include "client/library/haptics/renderer_impl.hpp"
#include "client/net/client_session.hpp"
#include "client/net/inline_preparation.hpp"

namespace hapticast {

namespace {

/// Converts the caller's time.
LocalTime toLocal(double time_s) {
  if (!(std::abs(time_s) <= 9e8))
    throw std::invalid_argument("time: " + std::to_string(time_s) + " s is outside +-9e8 s");
  return LocalTime(Duration(std::llround(1e9 * time_s)));
}

}  // namespace

class MessagePlayer::Impl {
 public:
  explicit Impl(Renderer::Impl& renderer)
      : preparation_(feed_->pool, clock_, renderer.method(),
                     [this](const client::PreparedFrame& frame) { receiver_.addPrepared(frame); }),
        receiver_(preparation_, feed_->timing, renderer.method() == Method::kThesis ? 2 : 1) {
    renderer.attach(feed_);
    open();
  }

  void push(std::span<const std::uint8_t> bytes, double arrival_s) {
    clock_.set(toLocal(arrival_s));
    const auto message = session_.receive(bytes, clock_.now());
    if (!message.ok()) {
      (void)session_.close(message.error(), clock_.now());
      open();
    }
    prepare();
    if (!message.ok()) throw std::runtime_error(message.error().why);
  }
  void release(double time_s) {
    clock_.set(toLocal(time_s));
    receiver_.release(clock_.now());
    prepare();
  }

 private:
  // The caller has said hello, and sends the pings.
  static client::SessionSettings makeSettings() {
    client::SessionSettings settings;
    settings.sends_pings = false;
    return settings;
  }
  void open() { (void)session_.open({.encrypted = true, .of_this_machine = true}, clock_.now()); }
  void prepare() {
    while (preparation_.step()) {
    }
  }
  SetClock clock_;
  std::shared_ptr<FrameFeed> feed_ = std::make_shared<FrameFeed>();
  client::InlinePreparation preparation_;
  client::Receiver receiver_;
  client::ClientSession session_{makeSettings(), &receiver_};
};

MessagePlayer::MessagePlayer(Renderer& renderer) : impl_(std::make_unique<Impl>(*renderer.impl_)) {}

MessagePlayer::~MessagePlayer() = default;

void MessagePlayer::push(std::span<const std::uint8_t> message, double arrival_s) {
  impl_->push(message, arrival_s);
}

void MessagePlayer::release(double time_s) { impl_->release(time_s); }

}  // namespace hapticast
