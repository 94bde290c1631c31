// SPDX-License-Identifier: MIT
// A client's session with any server: it sends what the protocol allows at this moment, accepts
// nothing before the welcome, keeps its limits, and always ends. The input is a script.
#include <cstdint>
#include <memory>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/net/client_session.hpp"
#include "client/net/inline_preparation.hpp"
#include "tests/fuzz/script.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::fuzz::client_session {
namespace {

using namespace hapticast;
using namespace hapticast::client;

struct Client {
  Client() { open(); }

  void open() {
    require(!session.open({}, clock.now()));
    require(!session.welcomed() && session.nextMessage() == LocalTime::max());
    const auto hello = session.poll(clock.now());
    require(hello && std::holds_alternative<Hello>(*hello));
    require(!session.poll(clock.now()));
  }
  /// Ends the session, and begins the next one after the pause.
  void end(const SessionEnd& why) {
    require(!why.why.empty());
    const auto pause = session.close(why, clock.now());
    require(!pause || *pause > Duration::zero());
    require(!session.poll(clock.now()) && !receiver.stream().connected);
    clock.advance(pause.value_or(std::chrono::seconds(1)));
    open();
  }
  void receive(std::span<const std::uint8_t> bytes) {
    const std::size_t welcomes = session.welcomes();
    const auto received = session.receive(bytes, clock.now());
    if (!received.ok()) return end(received.error());
    const bool is_welcome = std::holds_alternative<Welcome>(received.value());
    require(welcomes > 0 || is_welcome);
    require(session.welcomes() == welcomes + (is_welcome ? 1 : 0));
    require(bytes.size() <= kMaxMessageBytes);
  }
  /// Sends what is due. `answer` is where the pong of a ping differs from a true one.
  void poll(int answer) {
    int sent = 0;
    while (const auto message = session.poll(clock.now())) {
      require(session.welcomed() && ++sent <= 20);
      require(decode(encode(*message)).ok());
      require(!std::holds_alternative<Hello>(*message));
      const auto* const ping = std::get_if<Ping>(&*message);
      if (ping == nullptr || answer % 4 == 0) continue;
      Pong pong{ping->t0, mediaTime(answer), mediaTime(answer), {}};
      if (answer % 4 == 1) pong.t0 -= std::chrono::milliseconds(answer);
      receive(encode(pong));
    }
  }

  ManualClock clock;
  FramePool pool;
  LatestValue<StreamTiming> timing;
  InlinePreparation preparation{
      pool, clock, Method::kHapticast,
      [this](const PreparedFrame& frame) { receiver.addPrepared(frame); }};
  Receiver receiver{preparation, timing, 1};
  ClientSession session{{}, &receiver};
};

Message makeMessage(Script& script) {
  Welcome welcome{kProtocolVersion, 1, 0, {}};
  HapticFrame frame;
  switch (script.byte() % 8) {
    case 0:
      return Preparing{0.01 * script.byte()};
    case 1:
      return Control{};
    case 2:
      return Ping{};
    case 3:
      return WireError{static_cast<ErrorCode>(script.byte() % 12), "why"};
    case 4:
      frame.id = static_cast<std::uint64_t>(script.byte());
      frame.media_time = mediaTime(0.02 * script.byte());
      frame.objects.push_back({1, 0, 1, flatRelief({0, 0, 8, 8}), {}, nullptr, {}, {}});
      return testing::coded(frame);
    case 5: {
      StreamDescription description;
      description.workspace.width_px = 8 + script.byte();
      return description;
    }
    default:
      welcome.protocol_version += static_cast<std::uint32_t>(script.byte() / 250);
      welcome.description.workspace.width_px += script.byte();
      return welcome;
  }
}

}  // namespace

HAPTICAST_FUZZ_TARGET("client_session") {
  const auto client = std::make_unique<Client>();
  ClientSession& session = client->session;
  Script script{{data, size}};
  for (int step = 0; !script.rest.empty() && step < 500; ++step) {
    switch (script.byte() % 8) {
      case 0:
        client->receive(script.bytes());
        break;
      case 1:
        session.request(Delivery{});
        require(!session.request(Control{}) || session.welcomed());
        break;
      case 2:
        client->clock.advance(std::chrono::milliseconds(16 * script.byte()));
        if (const auto end = session.expire(client->clock.now())) client->end(*end);
        break;
      case 3:
      case 4:
        client->clock.advance(std::chrono::milliseconds(20));
        client->poll(script.byte());
        break;
      default:
        client->receive(encode(makeMessage(script)));
    }
  }
  // A server that falls silent ends the session, whatever came before.
  client->clock.advance(std::chrono::seconds(5));
  require(session.expire(client->clock.now()).has_value());
  return 0;
}

}  // namespace hapticast::fuzz::client_session
