// SPDX-License-Identifier: MIT
// The port for operators over loopback: what clients of every kind get, and what they cannot take
// from others.
#include "server/http/http_server.hpp"

#include "tests/integration/stream_fixture.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::testing {
namespace {

using server::HttpServer;

/// A client by hand: sends any text, reads what comes when asked to.
class HttpPeer {
 public:
  HttpPeer(asio::io_context& io, const HttpServer& http) : socket_(io) {
    socket_.connect({asio::ip::make_address("127.0.0.1"), http.address().port});
    socket_.non_blocking(true);
  }
  void send(const std::string& text) {
    boost::system::error_code ignored;  // the other side may have closed already
    asio::write(socket_, asio::buffer(text), ignored);
  }
  void poll() {
    std::string chunk(1U << 16U, '\0');
    boost::system::error_code ec;
    while (!closed) {
      const std::size_t size = socket_.read_some(asio::buffer(chunk), ec);
      if (ec == asio::error::would_block) return;
      closed = ec.failed();
      reset = ec.failed() && ec != asio::error::eof;
      text.append(chunk, 0, size);
    }
  }
  /// How many responses with this status have come.
  [[nodiscard]] std::size_t responses(const std::string& status = "") const {
    std::size_t count = 0;
    const std::string begin = "HTTP/1.1 " + status;
    for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at + 1))
      ++count;
    return count;
  }

  std::string text;
  bool closed = false;
  bool reset = false;

 private:
  asio::ip::tcp::socket socket_;
};

std::string get(const std::string& path, const std::string& fields = "") {
  return "GET " + path + " HTTP/1.1\r\nHost: a\r\n" + fields + "\r\n";
}

class HttpTest : public StreamTest {
 protected:
  HttpTest() { http.start(); }

  server::Metrics collect() {
    ++collected;
    server::Metrics metrics;
    metrics.now = manual.now();
    metrics.stream = stream.broadcaster.counts();
    return metrics;
  }
  bool closes(HttpPeer& peer) {
    return runUntil([&] {
      peer.poll();
      return peer.closed;
    });
  }
  bool getsResponses(HttpPeer& peer, std::size_t count) {
    return runUntil([&] {
      peer.poll();
      return peer.responses() >= count;
    });
  }
  /// The status of the one response to `text`, after which the connection ends in an orderly way.
  std::string finalStatus(const std::string& text) {
    HttpPeer peer(io, http);
    peer.send(text);
    EXPECT_TRUE(closes(peer)) << text.substr(0, 100);
    EXPECT_FALSE(peer.reset) << "the response could have been lost";
    EXPECT_EQ(peer.responses(), 1U) << peer.text;
    EXPECT_NE(peer.text.find("\r\nConnection: close\r\n"), std::string::npos) << peer.text;
    return peer.text.substr(9, 3);
  }

  using Peers = std::vector<std::unique_ptr<HttpPeer>>;
  /// Connects peers one after the other, and gives each some time.
  Peers connect(std::size_t count, const std::function<void(HttpPeer&)>& begin = {}) {
    Peers peers;
    for (std::size_t i = 0; i < count; ++i) {
      peers.push_back(std::make_unique<HttpPeer>(io, http));
      if (begin) begin(*peers.back());
      manual.advance(std::chrono::milliseconds(1));
      turn();
    }
    return peers;
  }

  TestServer stream{io, clock};
  ManualClock manual;
  int collected = 0;
  HttpServer http{io, manual, {"127.0.0.1", 0}, {"a"}, [this] { return collect(); }};
};

TEST_F(HttpTest, AnswersRequestsThatComeTogetherInOrder) {
  HttpPeer peer(io, http);
  peer.send(get("/health") + get("/nothing") + "HEAD /metrics HTTP/1.1\r\nHost: a\r\n\r\n" +
            get("/status.json", "Connection: close\r\n") + get("/health"));
  ASSERT_TRUE(closes(peer));
  EXPECT_FALSE(peer.reset);
  ASSERT_EQ(peer.responses(), 4U) << peer.text;
  EXPECT_EQ(peer.responses("200"), 3U);
  EXPECT_LT(peer.text.find("\r\n\r\nok: "), peer.text.find("404 Not Found"));
  EXPECT_EQ(peer.text.find("# HELP"), std::string::npos) << "HEAD has no body";
  EXPECT_TRUE(peer.text.ends_with("}\n")) << peer.text;
}

TEST_F(HttpTest, ANewcomerComesBeforeTheNinetiethRequestOfOthers) {
  std::string many;
  for (int i = 0; i < 90; ++i) many += get("/health");
  const Peers flood =
      connect(HttpServer::kMostConnections + 4, [&](HttpPeer& peer) { peer.send(many); });
  for (int i = 0; i < 10; ++i) {
    HttpPeer newcomer(io, http);
    newcomer.send(get("/health"));
    EXPECT_TRUE(getsResponses(newcomer, 1)) << i;
  }
  flood.back()->poll();
  EXPECT_LT(flood.back()->responses(), 90U) << "the flood is not over";
}

TEST_F(HttpTest, AnswersARequestThatComesInPortions) {
  HttpPeer peer(io, http);
  for (const char each : get("/health")) {
    EXPECT_EQ(peer.responses(), 0U);
    peer.send({each});
    turn();
    peer.poll();
  }
  EXPECT_TRUE(getsResponses(peer, 1));
}

TEST_F(HttpTest, RefusesWithTheStatusOfTheFault) {
  EXPECT_EQ(finalStatus("\x16\x03\x01\x02\x01"), "400");
  EXPECT_EQ(finalStatus("GET /metrics\r\n\r\n"), "400");
  EXPECT_EQ(finalStatus("GET /metrics HTTP/1.1\r\n\r\n"), "400");
  EXPECT_EQ(finalStatus(get("/metrics", "X: " + std::string(10'000, 'x') + "\r\n")), "431");
  EXPECT_EQ(finalStatus("GET /" + std::string(50'000, 'x')), "431");
  EXPECT_EQ(finalStatus(get("/metrics", "Content-Length: 30000\r\n") + std::string(30'000, 'x')),
            "413");
  for (const std::string coding : {"chunked", "xchunked"})
    EXPECT_EQ(finalStatus(get("/health", "Transfer-Encoding: " + coding + "\r\n") + get("/health")),
              "501")
        << "what follows is no second request";
  EXPECT_EQ(finalStatus("POST /metrics HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\nab"), "405");
  EXPECT_EQ(finalStatus("GET /health HTTP/1.0\r\n\r\n"), "200");
}

TEST_F(HttpTest, ClosesSlowConnections) {
  HttpPeer silent(io, http), slow(io, http), quick(io, http);
  slow.send("GET /heal");
  quick.send(get("/health"));
  ASSERT_TRUE(getsResponses(quick, 1));
  manual.advance(HttpServer::kTimeout - std::chrono::seconds(1));
  quick.send(get("/health"));
  ASSERT_TRUE(getsResponses(quick, 2));
  slow.send("th");  // a part of a request earns no more time
  turn();
  manual.advance(std::chrono::seconds(1));
  EXPECT_TRUE(closes(silent) && closes(slow));
  EXPECT_EQ(silent.text + slow.text, "");
  quick.send(get("/health"));
  EXPECT_TRUE(getsResponses(quick, 3)) << "its time began anew";
}

TEST_F(HttpTest, KeepsAtMostSixteenConnectionsThatHaveSentSomething) {
  const Peers peers = connect(20, [](HttpPeer& peer) { peer.send("GET /health HTTP"); });
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(closes(*peers[i])) << i;
  for (std::size_t i = 4; i < 20; ++i) {
    peers[i]->send("/1.1\r\nHost: a\r\n\r\n");
    EXPECT_TRUE(getsResponses(*peers[i], 1)) << i;
  }
}

TEST_F(HttpTest, KeepsTheNewestConnectionsThatHaveSentNothing) {
  const Peers peers = connect(HttpServer::kMostSilent + 4);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(closes(*peers[i])) << i;
  for (const std::size_t i : {std::size_t{4}, HttpServer::kMostSilent + 3}) {
    peers[i]->send(get("/health"));
    EXPECT_TRUE(getsResponses(*peers[i], 1)) << i;
  }
}

TEST_F(HttpTest, AFloodOfSilentConnectionsClosesNoneThatAsks) {
  HttpPeer quick(io, http), slow(io, http), idle(io, http);
  idle.send(get("/health"));
  ASSERT_TRUE(getsResponses(idle, 1));
  quick.send(get("/health"));  // it comes together with the flood
  const Peers before = connect(HttpServer::kMostSilent / 2);
  slow.send(get("/health"));  // in the middle of the flood
  turn();
  const Peers after = connect(HttpServer::kMostSilent);
  EXPECT_TRUE(getsResponses(quick, 1));
  EXPECT_TRUE(getsResponses(slow, 1));
  idle.send(get("/health"));
  EXPECT_TRUE(getsResponses(idle, 2));
}

TEST_F(HttpTest, AConnectionThatWaitsForItsTurnIsNotReplaced) {
  Peers peers;
  for (std::size_t i = 0; i < 2 * HttpServer::kMostConnections; ++i) {
    peers.push_back(std::make_unique<HttpPeer>(io, http));
    peers.back()->send(get("/health"));
  }
  for (std::size_t i = 0; i < HttpServer::kMostConnections; ++i)
    EXPECT_TRUE(getsResponses(*peers[i], 1)) << i;
  EXPECT_TRUE(closes(*peers.back())) << "no place was free";
}

/// A turn of the test lasts 2 ms or more, and one of the server 5 ms.
TEST_F(HttpTest, ConnectionsThatAreGoneCostNoTurn) {
  constexpr int kGone = 400;
  for (int i = 0; i < kGone; ++i) HttpPeer(io, http);
  HttpPeer peer(io, http);
  peer.send(get("/health"));
  int turns = 0;
  ASSERT_TRUE(runUntil([&] {
    ++turns;
    peer.poll();
    return peer.responses() == 1;
  }));
  EXPECT_LT(turns, kGone / 2);
}

TEST_F(HttpTest, RefusesAPageOfAnotherNameThatHasTheAddress) {
  EXPECT_EQ(
      finalStatus("GET /status.json HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n"),
      "421");
  EXPECT_EQ(collected, 0);
}

TEST_F(HttpTest, EndsAConnectionAfterAHundredRequests) {
  HttpPeer peer(io, http);
  std::string all;
  for (std::size_t i = 0; i < HttpServer::kMostRequests + 5; ++i) all += get("/health");
  peer.send(all);
  ASSERT_TRUE(closes(peer));
  EXPECT_EQ(peer.responses("200"), HttpServer::kMostRequests);
  EXPECT_EQ(collected, 1) << "figures are collected at most every 100 ms";
}

TEST_F(HttpTest, ShowsTheFiguresOfTheMoment) {
  HttpPeer peer(io, http);
  peer.send(get("/metrics"));
  ASSERT_TRUE(getsResponses(peer, 1));
  EXPECT_NE(peer.text.find("\nhapticast_viewers 0\n"), std::string::npos) << peer.text;
  const auto beside = viewer(stream);
  manual.advance(HttpServer::kFreshFor);
  peer.send(get("/metrics"));
  ASSERT_TRUE(getsResponses(peer, 2));
  EXPECT_NE(peer.text.find("\nhapticast_viewers 1\n"), std::string::npos) << peer.text;
}

TEST_F(HttpTest, RunsOutOfWorkWhenStopped) {
  HttpPeer peer(io, http);
  peer.send("GET /");
  turn();
  http.stop();
  stream.stop();
  EXPECT_TRUE(closes(peer));
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); })) << "nothing is left to wait for";
}

}  // namespace
}  // namespace hapticast::testing
