// SPDX-License-Identifier: MIT
#include "common/transport/tcp_channel.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/support/waiting.hpp"

namespace hapticast {
namespace {

using asio::ip::tcp;
using Bytes = std::vector<std::uint8_t>;

struct TcpChannelTest : ::testing::Test {
  TcpChannelTest() {
    tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    acceptor.set_option(asio::socket_base::receive_buffer_size(65536));  // who is accepted has it
    tcp::socket near(io);
    near.connect(acceptor.local_endpoint());
    far = acceptor.accept();
    near.set_option(asio::socket_base::send_buffer_size(20000));
    channel = std::make_unique<TcpChannel>(std::move(near), kMaxSmallMessageBytes);
  }
  static SharedBytes payload(std::size_t bytes) {
    std::vector<std::uint8_t> made(bytes);
    for (std::size_t i = 0; i < bytes; ++i) made[i] = static_cast<std::uint8_t>(i % 251);
    return std::make_shared<const std::vector<std::uint8_t>>(std::move(made));
  }
  asio::io_context io;
  tcp::socket far{io};
  std::unique_ptr<TcpChannel> channel;
};

TEST_F(TcpChannelTest, WritesDataThatFitsAtOnce) {
  const SharedBytes sent = payload(100);
  ASSERT_TRUE(channel->writeNow(sent, false));
  EXPECT_EQ(channel->bytesWritten(), kPrefixBytes + 100U);
  std::vector<std::uint8_t> got(kPrefixBytes + 100);
  asio::read(far, asio::buffer(got));
  EXPECT_EQ(got[0], 100U);
  EXPECT_TRUE(std::equal(sent->begin(), sent->end(), got.begin() + kPrefixBytes));
}

TEST_F(TcpChannelTest, AWriteGoesOnWhereWriteNowHasStopped) {
  const SharedBytes large = payload(1U << 20U), small = payload(10);
  ASSERT_FALSE(channel->writeNow(large, false)) << "more than the buffers hold";
  const std::uint64_t at_once = channel->bytesWritten();
  EXPECT_GT(at_once, 0U);
  bool written = false;
  asio::co_spawn(
      io,
      [&]() -> asio::awaitable<void> {
        written = co_await channel->write(large) && channel->writeNow(small, false);
      },
      asio::detached);
  std::vector<std::uint8_t> got(2 * kPrefixBytes + large->size() + small->size());
  asio::async_read(far, asio::buffer(got),
                   [](const boost::system::error_code& ec, std::size_t) { EXPECT_FALSE(ec); });
  io.run();
  EXPECT_TRUE(written);
  EXPECT_EQ(channel->bytesWritten(), got.size());
  LengthFraming reader(kMaxMessageBytes);
  reader.feed(got);
  for (const SharedBytes& each : {large, small}) {
    const auto next = reader.next();
    ASSERT_TRUE(next.ok() && next.value());
    EXPECT_TRUE(std::equal(next.value()->begin(), next.value()->end(), each->begin(), each->end()));
  }
}

TEST_F(TcpChannelTest, ReportsTheEndOfTheConnectionByTheWrite) {
  channel->close();
  const SharedBytes sent = payload(10);
  EXPECT_FALSE(channel->writeNow(sent, false));
  bool written = true;
  asio::co_spawn(
      io, [&]() -> asio::awaitable<void> { written = co_await channel->write(sent); },
      asio::detached);
  io.run();
  EXPECT_FALSE(written);
  EXPECT_FALSE(channel->whyEnded().empty());
}

/// The end of a server, and a socket that writes to it.
struct TcpChannelServerEndTest : TcpChannelTest {
  TcpChannelServerEndTest() {
    tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    peer.connect(acceptor.local_endpoint());
    channel = std::make_unique<TcpChannel>(acceptor.accept(), kMaxSmallMessageBytes, nullptr,
                                           ChannelEnd::kServer);
  }
  /// Sends `text` in `pieces` and returns what the channel reads.
  Result<std::optional<Bytes>, WireError> read(const std::vector<std::string>& pieces) {
    Result<std::optional<Bytes>, WireError> result{std::optional<Bytes>()};
    bool done = false;
    asio::co_spawn(
        io,
        [&]() -> asio::awaitable<void> {
          const auto payload = co_await channel->read();
          done = true;
          if (!payload.ok()) {
            result = payload.error();
          } else if (payload.value()) {
            result = std::optional(Bytes(payload.value()->begin(), payload.value()->end()));
          }
        },
        asio::detached);
    for (const std::string& piece : pieces) {
      asio::write(peer, asio::buffer(piece));
      io.restart();
      io.poll();
    }
    EXPECT_TRUE(waitUntil(std::chrono::seconds(60), [&] {
      io.restart();
      io.poll();
      return done;
    }));
    return result;
  }
  void sendAnswer() {
    asio::co_spawn(
        io, [&]() -> asio::awaitable<void> { co_await channel->answer(); }, asio::detached);
    io.restart();
    io.run();
  }
  std::string readAnswer() {
    std::string answer;
    boost::system::error_code ec;
    channel->close();
    asio::read(peer, asio::dynamic_buffer(answer), ec);
    return answer;
  }

  tcp::socket peer{io};
};

TEST_F(TcpChannelServerEndTest, ReadsAMessageWhosePrefixArrivesByteByByte) {
  const auto payload =
      read({std::string("\x02", 1), std::string("\0", 1), std::string("\0\0", 2), "a", "b"});
  ASSERT_TRUE(payload.ok() && payload.value());
  EXPECT_EQ(*payload.value(), (Bytes{'a', 'b'}));
}

TEST_F(TcpChannelServerEndTest, AnswersARequestOfHttpWithOneSentence) {
  const auto payload = read({"G", "ET", " / HTTP/1.1\r\nHost: a\r\n\r\n"});
  EXPECT_TRUE(payload.ok() && !payload.value()) << "it carries no payloads";
  EXPECT_EQ(channel->carrier(), Carrier::kHttp);
  EXPECT_EQ(channel->problem(), "a request of HTTP on the port for viewers");
  EXPECT_TRUE(channel->writeNow(TcpChannelTest::payload(10), false)) << "it sends no payload";
  sendAnswer();
  const std::string answer = readAnswer();
  const std::size_t body = answer.find("\r\n\r\n") + 4;
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 400 Bad Request\r\n")) << answer;
  const std::string length = "\r\nContent-Length: " + std::to_string(answer.size() - body) + "\r\n";
  EXPECT_NE(answer.find(length), std::string::npos) << answer;
}

}  // namespace
}  // namespace hapticast
