// SPDX-License-Identifier: MIT
// The cost of unauthorised clients and of viewers that do not read. They do not affect other
// viewers.
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <set>

#include "common/transport/tcp_channel.hpp"
#include "server/stream/listener.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/memory_channel.hpp"

namespace hapticast::testing {
namespace {

using UntrustedClientsTest = StreamTest;
using server::Broadcaster;
using std::chrono::milliseconds;

TEST_F(UntrustedClientsTest, ASilentClientKeepsNoViewerOut) {
  server::StreamSettings settings;
  settings.max_clients = 2;
  TestServer server(io, clock, settings);
  std::vector<std::unique_ptr<RawPeer>> silent;
  for (std::size_t i = 0; i < settings.max_clients + Broadcaster::kMaxPending + 8; ++i)
    silent.push_back(std::make_unique<RawPeer>(io, server.port()));
  const auto viewer_of_ours = viewer(server);
  server.publish(1);
  EXPECT_TRUE(receives<CodedFrame>(*viewer_of_ours));
  std::size_t turned_out = 0;
  for (const auto& each : silent) {
    each->poll();
    turned_out += each->closed ? 1 : 0;
  }
  EXPECT_EQ(turned_out, settings.max_clients + 9);
  EXPECT_TRUE(silent.front()->closed) << "the oldest go first";
  EXPECT_FALSE(silent.back()->closed);
}

TEST_F(UntrustedClientsTest, RemovesAClientOfTheMostFrequentAddress) {
  TestServer server(io, clock);
  RawPeer other(io, server.port(), 2);  // older than all of them
  std::vector<std::unique_ptr<RawPeer>> silent;
  for (std::size_t i = 0; i < 3 * Broadcaster::kMaxPending; ++i)
    silent.push_back(std::make_unique<RawPeer>(io, server.port()));
  ASSERT_TRUE(runUntil([&] {
    silent[2 * Broadcaster::kMaxPending]->poll();
    return silent[2 * Broadcaster::kMaxPending]->closed;
  }));
  other.send(Hello{kProtocolVersion, "patient", false, true});
  EXPECT_TRUE(receives<Welcome>(other));
}

TEST_F(UntrustedClientsTest, RemovesTheOldestClientIfAllAddressesDiffer) {
  TestServer server(io, clock);
  std::vector<std::unique_ptr<RawPeer>> silent;
  for (std::uint8_t i = 0; i < Broadcaster::kMaxPending; ++i) {
    silent.push_back(
        std::make_unique<RawPeer>(io, server.port(), static_cast<std::uint8_t>(20 + i)));
  }
  (void)viewer(server);  // of an address below all of them
  silent.front()->poll();
  EXPECT_TRUE(silent.front()->closed);
}

/// The server has read its hello when it removes the client: the hello comes too late.
TEST_F(UntrustedClientsTest, ARemovedClientIsNoViewer) {
  TestServer server(io, clock);
  std::vector<std::unique_ptr<MemoryChannel>> ours;
  const auto connectSilently = [&] {
    auto ends = MemoryChannel::pair(io, kMaxSmallMessageBytes);
    ours.push_back(std::move(ends.first));
    server.broadcaster.accept(std::move(ends.second));
  };
  for (std::size_t i = 0; i < Broadcaster::kMaxPending; ++i) connectSilently();
  io.restart();
  io.poll();  // all of them wait for a hello
  const auto hello = std::make_shared<const std::vector<std::uint8_t>>(encode(Hello{}));
  asio::co_spawn(
      io, [&]() -> asio::awaitable<void> { co_await ours[0]->write(hello); }, asio::detached);
  io.poll_one();  // it is written, and not yet read
  connectSilently();
  io.restart();
  io.poll();
  EXPECT_EQ(server.broadcaster.counts().welcomed, 0U);
  server.stop();
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); })) << "nobody is left behind";
}

TEST_F(UntrustedClientsTest, AtTheEndEveryViewerReceivesGoodbye) {
  TestServer server(io, clock);
  std::vector<std::unique_ptr<RawPeer>> viewers;
  for (std::size_t i = 0; i < Broadcaster::kMaxPending + 8; ++i) viewers.push_back(viewer(server));
  server.stop();
  for (const auto& each : viewers) EXPECT_EQ(farewell(*each).code, ErrorCode::kShuttingDown);
}

TEST_F(UntrustedClientsTest, TheEndOfTheServerGivesAClosedPeerNoMoreTime) {
  ManualClock still;
  server::StreamSettings settings;
  settings.goodbye_deadline = std::chrono::seconds(10);
  TestServer server(io, still, settings);
  RawPeer peer(io, server.port());  // it never ends its own side
  peer.send(std::vector<std::uint8_t>(100, 0xFF));
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().refused == 1; }));
  still.advance(std::chrono::seconds(6));
  server.stop();
  turn();
  still.advance(std::chrono::seconds(6));
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
}

TEST_F(UntrustedClientsTest, TheWelcomeComesBeforeThePong) {
  TestServer server(io, clock);
  RawPeer peer(io, server.port());
  std::vector<std::uint8_t> both = framed(encode(Hello{kProtocolVersion, "quick", false, true}));
  const std::vector<std::uint8_t> ping = framed(encode(Ping{localTime(1.0)}));
  both.insert(both.end(), ping.begin(), ping.end());
  peer.send(both);
  ASSERT_TRUE(runUntil([&] {
    peer.poll();
    return peer.got.size() >= 2;
  }));
  EXPECT_TRUE(std::holds_alternative<Welcome>(peer.got[0]));
  EXPECT_TRUE(std::holds_alternative<Pong>(peer.got[1]));
}

TEST_F(UntrustedClientsTest, AHalfClosedClientGetsTheReasonOfItsEnd) {
  TestServer server(io, clock);
  const auto peer = viewer(server);
  peer->finish();
  EXPECT_EQ(farewell(*peer).code, ErrorCode::kUnexpected);
  EXPECT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
}

/// Data for a viewer that reads on after a stop, when it was closed: the system
/// has forgotten what it did not take, so that the connection ends in a reset.
TEST_F(UntrustedClientsTest, AStalledViewerLeavesNothingInTheKernel) {
  for (const bool half_closed : {false, true}) {
    server::StreamSettings settings;
    settings.write_timeout = milliseconds(300);
    settings.goodbye_deadline = milliseconds(300);
    TestServer server(io, clock, settings);
    const auto stalled = viewer(server);
    std::uint64_t id = 0;
    ASSERT_TRUE(runUntil([&] {
      server.publish(++id, 900);
      return server.broadcaster.counts().sent.dropped() > 0;
    })) << "its buffers are full";
    if (half_closed) stalled->finish();
    ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
    const auto later = clock.now() + 2 * settings.goodbye_deadline;
    ASSERT_TRUE(runUntil([&] { return clock.now() > later; }));
    ASSERT_TRUE(runUntil([&] {
      stalled->poll();
      return stalled->closed;
    }));
    EXPECT_TRUE(stalled->reset) << (half_closed ? "half closed" : "open");
    server.stop();
    io.restart();
    EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
  }
}

TEST_F(UntrustedClientsTest, TheLogStaysReadable) {
  const LogLines log;
  const ManualClock still;  // no further line is earned meanwhile
  TestServer server(io, still);
  for (int i = 0; i < 60; ++i) (void)viewer(server);
  RawPeer(io, server.port()).send(std::vector<std::uint8_t>(100, 0xFF));
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
  EXPECT_LE(log.count(), 2 * RateLimiter::kLogBurst);
  EXPECT_NE(log.text().find("joined"), std::string::npos);
  EXPECT_NE(log.text().find("closing"), std::string::npos) << "a crowd hides no problem";
}

/// A server with one valid token, of which time passes only by hand.
class UntrustedClientsGuessTest : public StreamTest {
 protected:
  UntrustedClientsGuessTest() {
    const std::string digest_of_a =
        "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb";
    server.broadcaster.setAccess(
        server::AccessList::parse(digest_of_a + " viewer never\n").value());
    turn();
  }
  using Peers = std::vector<std::unique_ptr<RawPeer>>;
  /// Peers of 127.0.0.`from` that send `token` after the same hello.
  Peers guess(std::size_t count, const std::string& token, std::uint8_t from = 1) {
    Peers peers;
    for (std::size_t i = 0; i < count; ++i) {
      peers.push_back(std::make_unique<RawPeer>(io, server.port(), from));
      peers.back()->send(Hello{kProtocolVersion, "guess", false, true, token});
    }
    return peers;
  }
  /// Waits until the server has read the hellos of these peers and of all before them.
  void expectRead(const std::string& token = "a") {
    const Peers valid = guess(1, token);
    EXPECT_TRUE(receives<Welcome>(*valid[0])) << "a valid token of the same network waits for none";
  }
  static std::size_t countAnswered(const Peers& peers) {
    std::size_t count = 0;
    for (const auto& each : peers) {
      each->poll();
      const auto errors = each->all<WireError>();
      EXPECT_LE(errors.size(), 1U);
      EXPECT_TRUE(errors.empty() || errors[0].code == ErrorCode::kUnauthorized);
      count += errors.size();
    }
    return count;
  }
  /// Whether `count` of the peers are answered, and no more some turns later.
  bool answers(const Peers& peers, std::size_t count) {
    if (!runUntil([&] { return countAnswered(peers) >= count; })) return false;
    for (int i = 0; i < 50; ++i) turn();  // the server looks after its deadlines every 50 ms
    return countAnswered(peers) == count;
  }

  ManualClock still;
  TestServer server{io, still};
};

TEST_F(UntrustedClientsGuessTest, OneOfANetworkIsAnsweredInASecond) {
  const Peers peers = guess(3, "wrong");
  const Peers elsewhere = guess(1, "wrong", 2);
  EXPECT_TRUE(answers(elsewhere, 1)) << "another network does not wait";
  expectRead();
  for (std::size_t answered = 1; answered <= 3; ++answered) {
    EXPECT_TRUE(answers(peers, answered)) << answered;
    still.advance(milliseconds(999));
    EXPECT_TRUE(answers(peers, answered)) << answered;
    still.advance(milliseconds(1));
  }
  for (const auto& each : peers) EXPECT_EQ(farewell(*each).code, ErrorCode::kUnauthorized);
}

TEST_F(UntrustedClientsGuessTest, AConnectionThatWaitsForItsAnswerDoesNothingElse) {
  const Peers peers = guess(2, "wrong");
  for (const auto& each : peers) {
    each->send(Hello{kProtocolVersion, "guess", false, true, "a"});
    each->send(Ping{localTime(1.0)});
    each->send(std::vector<std::uint8_t>(100, 0xFF));
  }
  expectRead();
  still.advance(std::chrono::seconds(1));
  EXPECT_TRUE(answers(peers, 2));
  for (const auto& each : peers) EXPECT_TRUE(each->all<Welcome>().empty());
  EXPECT_EQ(server.broadcaster.counts().welcomed, 1U);
}

TEST_F(UntrustedClientsGuessTest, GuessesBeyondTheDeadlineOfTheHelloAreClosedAtOnce) {
  constexpr std::size_t kGuesses = 30;
  constexpr std::size_t kAnswered = 6;  // now and each second until the deadline, 5 s
  const Peers peers = guess(kGuesses, "wrong");
  ASSERT_TRUE(runUntil([&] {
    for (const auto& each : peers) each->poll();
    return std::count_if(peers.begin(), peers.end(),
                         [](const auto& each) { return each->reset; }) == kGuesses - kAnswered;
  }));
  for (std::size_t second = 0; second < kAnswered; ++second) {
    EXPECT_TRUE(answers(peers, second + 1));
    still.advance(std::chrono::seconds(1));
  }
  EXPECT_TRUE(answers(peers, kAnswered));
  EXPECT_EQ(server.broadcaster.counts().refused, kGuesses);
  EXPECT_EQ(server.broadcaster.counts().timed_out, 0U);
}

TEST_F(UntrustedClientsGuessTest, TheEndOfTheServerLeavesNoneOfThemBehind) {
  const Peers peers = guess(3, "wrong");
  expectRead();
  server.stop();
  ASSERT_TRUE(runUntil([&] {
    for (const auto& each : peers) each->poll();
    return std::all_of(peers.begin(), peers.end(), [](const auto& each) { return each->closed; });
  }));
  still.advance(std::chrono::seconds(2));  // the peers do not end their own side
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
}

TEST_F(UntrustedClientsTest, AnIPv4ViewerOfAnIPv6PortIsShownAsOne) {
  boost::system::error_code ec;
  asio::ip::tcp::acceptor acceptor(io);
  acceptor.open(asio::ip::tcp::v6(), ec);
  if (ec) GTEST_SKIP() << "no IPv6 here: " << ec.message();
  acceptor.bind({asio::ip::address_v6::any(), 0});
  acceptor.listen();
  const RawPeer peer(io, acceptor.local_endpoint().port());
  const TcpChannel channel(acceptor.accept(), kMaxSmallMessageBytes);
  EXPECT_EQ(channel.peer().rfind("127.0.0.1:", 0), 0U) << channel.peer();
}

TEST_F(UntrustedClientsTest, AnotherViewerIsServedFirstEveryTime) {
  TestServer server(io, clock);
  std::vector<std::unique_ptr<MemoryChannel>> ours;
  std::vector<std::size_t> arrivals;  // who got something, in order
  const auto hello = std::make_shared<const std::vector<std::uint8_t>>(
      encode(Hello{kProtocolVersion, "", true, true}));
  for (std::size_t i = 0; i < 2; ++i) {
    auto ends = MemoryChannel::pair(io, kMaxSmallMessageBytes);
    ours.push_back(std::move(ends.first));
    server.broadcaster.accept(std::move(ends.second));
    const auto receive = [&, i]() -> asio::awaitable<void> {
      co_await ours[i]->write(hello);
      for (;;) {
        const auto payload = co_await ours[i]->read();
        if (!payload.ok() || !payload.value()) co_return;
        arrivals.push_back(i);
      }
    };
    asio::co_spawn(io, receive, asio::detached);
  }
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 2; }));
  std::multiset<std::size_t> first;
  ASSERT_TRUE(runUntil([&] { return arrivals.size() == 2; })) << "the welcomes";
  for (std::uint64_t id = 1; id <= 6; ++id) {
    arrivals.clear();
    server.publish(id);
    server.broadcaster.publish(server::encodeVideo({0, id, server.media.now(), {0xFF, 0xD8}}));
    ASSERT_TRUE(runUntil([&] { return arrivals.size() == 4; }));
    first.insert(arrivals[0]);
  }
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(first.count(i), 3U) << i;
}

TEST(UntrustedClientsFileLimit, IsRaisedForTheViewersOrReportsHowManyFit) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  rlimit low = before;
  low.rlim_cur = 100;
  if (low.rlim_max < 1000) GTEST_SKIP() << "this system allows only " << low.rlim_max << " files";
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
  EXPECT_EQ(server::raiseFileLimit(500), 500U);
  rlimit raised{};
  getrlimit(RLIMIT_NOFILE, &raised);
  EXPECT_GE(raised.rlim_cur, 500U + Broadcaster::kMaxPending);
  setrlimit(RLIMIT_NOFILE, &before);

  const auto fits_only = [] {  // in a process of its own: a hard limit cannot be raised again
    const rlimit hard{150, 150};
    setrlimit(RLIMIT_NOFILE, &hard);
    LogLines log;
    const std::size_t fit = server::raiseFileLimit(2000);
    const bool logged = log.text().find("--max-clients 2000") != std::string::npos &&
                        log.text().find("enough for " + std::to_string(fit)) != std::string::npos;
    std::_Exit(fit == 150 - 64 - Broadcaster::kMaxPending && logged ? 0 : 1);
  };
  EXPECT_EXIT(fits_only(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace hapticast::testing
