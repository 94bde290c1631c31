// SPDX-License-Identifier: MIT
// A server's session against any peer: what it answers is always in the order of the protocol, it
// never keeps more than it may, and it always ends. The input is a script of steps: a byte says
// what happens, two bytes how much of the rest is a payload.
#include <spdlog/spdlog.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "server/stream/session.hpp"
#include "tests/fuzz/script.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/memory_channel.hpp"

namespace hapticast::fuzz::session {
namespace {

using namespace hapticast;

struct Host final : server::SessionHost {
  Host() : media(manual) { spdlog::set_level(spdlog::level::off); }
  [[nodiscard]] const Clock& clock() const override { return manual; }
  [[nodiscard]] const MediaClock& mediaClock() const override { return media; }
  [[nodiscard]] const server::StreamSettings& settings() const override { return stream_settings; }
  [[nodiscard]] const StreamDescription& description() const override { return stream; }
  [[nodiscard]] std::optional<WireError> refuse(const Hello& hello, const Channel&) const override {
    if (hello.access_token == "wrong") return WireError{ErrorCode::kUnauthorized, "wrong token"};
    if (hello.protocol_version == kProtocolVersion) return std::nullopt;
    return WireError{ErrorCode::kVersion, "another version"};
  }
  [[nodiscard]] std::optional<LocalTime> reserveRefusal(const server::Session&,
                                                        LocalTime latest) override {
    next_refusal += std::chrono::seconds(1);
    return next_refusal <= latest ? std::optional(next_refusal) : std::nullopt;
  }
  [[nodiscard]] std::optional<server::Grant> findGrant(const Hello& hello) const override {
    if (hello.access_token.empty()) return std::nullopt;
    return server::Grant{{}, server::Role::kOperator, std::nullopt};
  }
  [[nodiscard]] std::optional<WireError> control(
      const Control& control, const std::shared_ptr<server::Session>& sender) override {
    require(!control.seek_s || *control.seek_s >= 0.0);
    if (!sender->grant()) return WireError{ErrorCode::kForbidden, "no operator"};
    sender->confirm(control);
    return std::nullopt;
  }
  void completeWelcome(const Channel&, Welcome&) override {}
  void deliver(std::uint64_t token, const Delivery& delivery) override {
    require(token == 0 && delivery.copies >= 1 && delivery.copies <= 4);
  }
  void onRequest(const std::shared_ptr<server::Session>&, const std::string&) override {}
  void onJoined(server::Session&) override { ++welcomed; }
  void onClosing(const std::shared_ptr<server::Session>&,
                 const std::optional<WireError>&) override {}
  void onClosed(const std::shared_ptr<server::Session>&) override { has_ended = true; }

  ManualClock manual;
  LocalMediaClock media;
  server::StreamSettings stream_settings;
  StreamDescription stream;
  LocalTime next_refusal{};
  int welcomed = 0;
  bool has_ended = false;
};

asio::awaitable<void> tell(testing::MemoryChannel& peer, SharedBytes bytes) {
  co_await peer.write(std::move(bytes));
}

/// The peer's end: checks what comes.
asio::awaitable<void> hear(testing::MemoryChannel& peer) {
  bool first = true;
  bool over = false;
  for (;;) {
    const auto payload = co_await peer.read();
    if (!payload.ok() || !payload.value()) co_return;
    const auto message = decode(*payload.value());
    require(message.ok() && !over);
    over = std::holds_alternative<WireError>(message.value());
    require(first == (std::holds_alternative<Welcome>(message.value()) || (first && over)));
    first = false;
  }
}

server::EncodedFrame frameOf(std::uint64_t id, const MediaClock& clock) {
  HapticFrame frame;
  frame.id = id;
  frame.media_time = clock.now();
  frame.objects.push_back({1, 0, 1, flatRelief({0, 0, 8, 8}), {}, nullptr, {}, {}});
  return server::FrameEncoder().encode(frame);
}

}  // namespace

HAPTICAST_FUZZ_TARGET("session") {
  static const SharedBytes kHello = encodeShared(Hello{kProtocolVersion, "fuzz", true, true});
  static const SharedBytes kWrongToken =
      encodeShared(Hello{kProtocolVersion, "fuzz", true, true, "wrong"});
  asio::io_context io;
  Host host;
  auto [peer, ours] = testing::MemoryChannel::pair(io, kMaxMessageBytes);
  ours->setReadLimit(kMaxSmallMessageBytes);
  const auto session = std::make_shared<server::Session>(io, std::move(ours), host, 1);
  session->start();
  asio::co_spawn(io, hear(*peer), asio::detached);
  const auto say = [&io, &peer = peer](SharedBytes bytes) {
    if (bytes->empty()) return;  // no channel carries that
    asio::co_spawn(io, tell(*peer, std::move(bytes)), asio::detached);
  };
  Script script{{data, size}};
  for (std::uint64_t step = 1; !script.rest.empty() && step < 500; ++step) {
    switch (script.byte() % 9) {
      case 0: {
        const auto bytes = script.bytes();
        say(std::make_shared<const std::vector<std::uint8_t>>(bytes.begin(), bytes.end()));
        break;
      }
      case 1:
        say(kHello);
        break;
      case 2:
        say(encodeShared(Ping{host.manual.now()}));
        break;
      case 3:
        say(encodeShared(ReceiverReport{}));
        break;
      case 4:
        session->send(frameOf(step, host.media));
        break;
      case 5:
        session->queue(encodeShared(host.stream), script.byte() % 2 == 0);
        session->flush();
        break;
      case 6:
        host.manual.advance(std::chrono::milliseconds(10 * script.byte()));
        session->check(host.manual.now());
        break;
      case 8:
        say(kWrongToken);
        break;
      default:
        session->queue(server::encodeVideo({0, step, host.media.now(), {0xFF, 0xD8}}));
        session->flush();
        break;
    }
    io.restart();
    io.poll();
  }
  require(host.welcomed <= 1);
  // A peer that falls silent is left after the longest of the deadlines, whatever it said before.
  for (int i = 0; i < 30 && !host.has_ended; ++i) {
    host.manual.advance(std::chrono::seconds(1));
    session->check(host.manual.now());
    io.restart();
    io.poll();
  }
  require(host.has_ended);
  peer->close();
  io.restart();
  io.poll();
  return 0;
}

}  // namespace hapticast::fuzz::session
