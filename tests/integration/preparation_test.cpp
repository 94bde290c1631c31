// SPDX-License-Identifier: MIT
// The network thread works while the decode thread is busy.
#include <atomic>
#include <thread>

#include "client/net/decode_thread.hpp"
#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

using PreparationTest = StreamTest;

/// Who asks for the time waits until the test lets it go: a preparation that takes that long.
struct HeldClock final : Clock {
  [[nodiscard]] LocalTime now() const noexcept override {
    asked = true;
    held.wait(true);
    return SteadyClock().now();
  }
  mutable std::atomic<bool> asked{false};
  std::atomic<bool> held{true};
};

TEST_F(PreparationTest, PongsAreStampedWhileAFrameIsPrepared) {
  asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
  acceptor.non_blocking(true);
  const auto pool = std::make_unique<client::FramePool>();
  LatestValue<client::StreamTiming> stream;
  HeldClock busy;
  std::unique_ptr<client::Receiver> receiver;
  client::DecodeThread decode_thread(*pool, busy, Method::kHapticast, [&](const auto& frame) {
    asio::post(io, [&receiver, frame] { receiver->addPrepared(frame); });
  });
  receiver = std::make_unique<client::Receiver>(decode_thread, stream, 1);
  client::Connection connection(
      io, clock, TestClient::settings(acceptor.local_endpoint().port(), {}), *receiver, {});
  decode_thread.start();
  connection.start();

  std::unique_ptr<RawPeer> server;
  ASSERT_TRUE(runUntil([&] {
    boost::system::error_code ec;
    auto socket = acceptor.accept(ec);
    if (!ec) server = std::make_unique<RawPeer>(std::move(socket));
    return !ec;
  }));
  server->send(Welcome{kProtocolVersion, 1, 0, TestServer::description()});
  server->send(CodedFrame{});
  ASSERT_TRUE(runUntil([&] { return busy.asked.load(); }));

  std::size_t answered = 0;
  EXPECT_TRUE(runUntil([&] {
    server->poll();
    const auto pings = server->all<Ping>();
    for (; answered < pings.size(); ++answered) {
      const MediaTime now(clock.now().time_since_epoch());
      server->send(Pong{pings[answered].t0, now, now});
    }
    return stream.load().connected;
  })) << "the clock is known before the frame is ready";
  EXPECT_EQ(receiver->counts().received, 0U);
  busy.held = false;
  busy.held.notify_all();
  EXPECT_TRUE(runUntil([&] { return receiver->counts().received == 1; }));
  decode_thread.stop();
  connection.stop();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
}

}  // namespace
}  // namespace hapticast::testing
