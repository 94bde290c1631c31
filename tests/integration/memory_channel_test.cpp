// SPDX-License-Identifier: MIT
// Both halves of the protocol without a socket: the client's connection and the server's session
// over channels in memory. What holds here holds for every transport.
#include "tests/support/memory_channel.hpp"

#include "tests/integration/stream_fixture.hpp"

namespace hapticast::testing {
namespace {

class MemoryChannelTest : public StreamTest {
 protected:
  /// What a client dials with to reach `broadcaster`.
  client::Dial dialTo(server::Broadcaster& broadcaster) {
    return [this, &broadcaster](asio::io_context&, const Endpoint&, Duration,
                                client::DialCancellation&) -> asio::awaitable<client::Dialled> {
      auto [ours, theirs] = MemoryChannel::pair(io, kMaxSmallMessageBytes);
      broadcaster.accept(std::move(theirs));
      if (unwilling > 0) {
        --unwilling;
        co_return client::DialError{"not today"};
      }
      co_return std::move(ours);
    };
  }
  int unwilling = 0;
};

TEST_F(MemoryChannelTest, CarriesTheWholeProtocol) {
  TestServer server(io, clock);
  TestClient client(io, clock, 0, [&](auto& settings) {
    settings.dial = dialTo(server.broadcaster);
    settings.wants_video = true;
  });
  ASSERT_TRUE(runUntil([&] { return client.stream.load().connected; }));
  for (std::uint64_t id = 1; id <= 10; ++id) server.publish(id, 8, false);
  server.broadcaster.publish(server::encodeVideo({0, 10, server.media.now(), {0xFF, 0xD8, 1}}));
  ASSERT_TRUE(runUntil([&] {
    client.drain();
    return !client.frames.empty() && client.frames.back().second == 10 && client.videos.size() == 1;
  }));
  EXPECT_TRUE(client.last_has_field);
  EXPECT_GT(client.connection.bytesReceived(), 0U);
  server.stop();
  ASSERT_TRUE(runUntil([&] { return !client.lost.empty(); }));
  EXPECT_NE(client.lost[0].find("the server ends"), std::string::npos) << client.lost[0];
}

TEST_F(MemoryChannelTest, AClientDialsAgainUntilItIsLetIn) {
  TestServer server(io, clock);
  unwilling = 2;
  TestClient client(io, clock, 0,
                    [&](auto& settings) { settings.dial = dialTo(server.broadcaster); });
  ASSERT_TRUE(runUntil([&] { return client.welcomes == 1; }));
  ASSERT_EQ(client.lost.size(), 2U);
  EXPECT_EQ(client.lost[0], "not today");
}

TEST_F(MemoryChannelTest, APayloadAboveTheLimitGetsItsErrorAndTheEnd) {
  TestServer server(io, clock);
  auto ends = MemoryChannel::pair(io, kMaxMessageBytes);
  const auto ours = std::move(ends.first);
  ends.second->setReadLimit(kMaxSmallMessageBytes);
  server.broadcaster.accept(std::move(ends.second));
  std::vector<ErrorCode> errors;
  bool ended = false;
  asio::co_spawn(
      io,
      [&]() -> asio::awaitable<void> {
        const std::vector<std::uint8_t> large(kMaxSmallMessageBytes + 1, 7);
        co_await ours->write(std::make_shared<const std::vector<std::uint8_t>>(large));
        for (auto payload = co_await ours->read(); payload.ok() && payload.value();
             payload = co_await ours->read()) {
          errors.push_back(std::get<WireError>(decode(*payload.value()).value()).code);
        }
        ours->close();
        ended = true;
      },
      asio::detached);
  ASSERT_TRUE(runUntil([&] { return ended; }));
  EXPECT_EQ(errors, std::vector{ErrorCode::kTooLarge});
  EXPECT_EQ(server.broadcaster.counts().refused, 1U);
}

}  // namespace
}  // namespace hapticast::testing
