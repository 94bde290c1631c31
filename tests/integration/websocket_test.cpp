// SPDX-License-Identifier: MIT
// Viewers by WebSocket over loopback, with a client that shares no code with the server: they get
// what viewers by TCP get, and their faults affect no other viewer.
#include <gmock/gmock.h>

#include <boost/asio/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include "tests/integration/datagram_fixture.hpp"
#include "tests/integration/websocket_viewer.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/websocket_frames.hpp"

namespace hapticast::testing {
namespace {

using Viewer = WebSocketViewer<asio::ip::tcp::socket>;
using TlsViewer = WebSocketViewer<asio::ssl::stream<asio::ip::tcp::socket>>;
using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;

class WebSocketTest : public StreamTest {
 protected:
  template <class V, class M>
  bool gets(V& viewer, std::size_t count = 1) {
    return runUntil([&] { return viewer.template all<M>().size() >= count || viewer.ended; }) &&
           viewer.template all<M>().size() >= count;
  }
  /// A viewer that has been welcomed.
  std::unique_ptr<Viewer> browser(const TestServer& server, WebSocketRequest request = {}) {
    auto viewer = std::make_unique<Viewer>(io, server.port(), std::move(request));
    viewer->send(Hello{kProtocolVersion, "browser", false, true});
    EXPECT_TRUE((gets<Viewer, Welcome>(*viewer))) << viewer->error.message();
    return viewer;
  }
  bool ends(const Viewer& viewer) {
    return runUntil([&] { return viewer.ended; });
  }
  static std::string upgrade(const TestServer& server) {
    const std::string host = "127.0.0.1:" + std::to_string(server.port());
    return "GET /stream HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host +
           "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
           "Sec-WebSocket-Protocol: hapticast.3\r\n\r\n";
  }
  static Bytes toBytes(const std::string& text) { return {text.begin(), text.end()}; }
};

/// Payloads of the kinds that all viewers get alike.
std::vector<Bytes> selectFrames(const std::vector<Bytes>& payloads) {
  std::vector<Bytes> frames;
  for (const Bytes& each : payloads) {
    const auto message = decode(each);
    if (message.ok() && std::holds_alternative<CodedFrame>(message.value())) frames.push_back(each);
  }
  return frames;
}

TEST_F(WebSocketTest, GetsTheBytesOfAViewerByTcp) {
  TestServer server(io, clock);
  const auto tcp = viewer(server);
  tcp->keeps_payloads = true;
  const auto web = browser(server);
  for (std::uint64_t id = 1; id <= 40; ++id) {
    server.publish(id, id % 10 == 0 ? 300 : id % 3 == 0 ? 20 : 4);  // prefixes of 2, 4, 10 bytes
    ASSERT_TRUE(receives<CodedFrame>(*tcp, id));
    ASSERT_TRUE((gets<Viewer, CodedFrame>(*web, id)));
  }
  const auto frames = selectFrames(web->payloads);
  EXPECT_EQ(frames, selectFrames(tcp->payloads));
  EXPECT_TRUE(std::any_of(frames.begin(), frames.end(),
                          [](const Bytes& each) { return each.size() > 65535; }));
  const auto counts = server.broadcaster.counts();
  EXPECT_EQ(counts.clients, 2U);
  EXPECT_EQ(counts.websockets, 1U);
}

TEST_F(WebSocketTest, AnswersThePingsOfBothLayers) {
  TestServer server(io, clock);
  const auto web = browser(server);
  web->ping("one");
  web->ping("two");
  web->send(Ping{localTime(1.25)});
  ASSERT_TRUE((gets<Viewer, Pong>(*web)));
  EXPECT_EQ(web->all<Pong>()[0].t0, localTime(1.25));
  ASSERT_TRUE(runUntil([&] {
    server.publish(1);
    return !web->pongs.empty();
  }));
  EXPECT_TRUE(web->pongs.back() == "two" || web->pongs.back() == "one");
}

TEST_F(WebSocketTest, GetsNoDatagramsAndTheWelcomeOfATakeover) {
  DatagramServer server(io, clock);
  const auto tcp = viewer(server);
  EXPECT_NE(tcp->all<Welcome>()[0].datagram_token, 0U);
  const auto web = browser(server);
  const Welcome first = web->all<Welcome>()[0];
  EXPECT_EQ(first.datagram_token, 0U);
  EXPECT_EQ(first.group, std::nullopt);
  EXPECT_EQ(first.verifying_key, server.signer.identity().verifying_key);
  server.publish(7);
  ASSERT_TRUE((gets<Viewer, CodedFrame>(*web)));
  server.changeOrigin();
  server.publish(1);
  ASSERT_TRUE((gets<Viewer, Welcome>(*web, 2)));
  EXPECT_EQ(web->all<Welcome>()[1].verifying_key, server.other.identity().verifying_key);
  EXPECT_EQ(web->all<Welcome>()[1].datagram_token, 0U);
  ASSERT_TRUE((gets<Viewer, CodedFrame>(*web, 2)));
}

TEST_F(WebSocketTest, GetsAGoodbyeWithACloseFrame) {
  TestServer server(io, clock);
  const auto web = browser(server);
  server.stop();
  ASSERT_TRUE(ends(*web));
  ASSERT_EQ(web->all<WireError>().size(), 1U);
  EXPECT_EQ(web->all<WireError>()[0].code, ErrorCode::kShuttingDown);
  EXPECT_EQ(web->close_code, 1000);
}

TEST_F(WebSocketTest, ACloseOfTheViewerIsAnswered) {
  TestServer server(io, clock);
  const auto web = browser(server);
  web->close();
  ASSERT_TRUE(ends(*web));
  EXPECT_EQ(web->close_code, 1000);
  EXPECT_TRUE(runUntil([&] { return server.broadcaster.counts().clients == 0; }));
}

TEST_F(WebSocketTest, ASlowViewerLosesWholeFramesOnly) {
  server::StreamSettings settings;
  settings.send_buffer_bytes = 20'000;
  TestServer server(io, clock, settings);
  const auto tcp = viewer(server);
  const auto slow = browser(server);
  slow->stall(true);
  std::uint64_t id = 0;
  ASSERT_TRUE(runUntil([&] {
    server.publish(++id, 300);
    tcp->poll();
    slow->ping("p" + std::to_string(id));
    return server.broadcaster.counts().sent.dropped() > 5;
  }));
  slow->stall(false);
  ASSERT_TRUE(runUntil([&] {
    server.publish(++id, 8);
    tcp->poll();
    const auto frames = slow->all<CodedFrame>();
    return !frames.empty() && frames.back().id + 2 > id && id > 30;
  })) << slow->error.message();
  EXPECT_FALSE(slow->ended);
  for (const Bytes& each : slow->payloads) EXPECT_TRUE(decode(each).ok());
  EXPECT_EQ(slow->pongs.back().front(), 'p');
  EXPECT_TRUE(receives<CodedFrame>(*tcp));
}

TEST_F(WebSocketTest, OfferedCompressionIsNotUsed) {
  TestServer server(io, clock);
  const auto web = browser(server, {.deflate = true});
  EXPECT_EQ(web->response.count("Sec-WebSocket-Extensions"), 0U);
  EXPECT_EQ(web->response["Sec-WebSocket-Protocol"], "hapticast.3");
  server.publish(1);
  EXPECT_TRUE((gets<Viewer, CodedFrame>(*web)));
}

TEST_F(WebSocketTest, BytesThatAreNoFrameEndOneViewerOnly) {
  const LogLines log;
  TestServer server(io, clock);
  const auto tcp = viewer(server);
  const auto web = browser(server);
  std::uint64_t id = 0;
  const std::vector<Bytes> wrong{
      {0x82, 0xFF, 0x80, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 4},           // 2^63 bytes
      {0x82, 0xFF, 0, 0, 0, 0, 0x7F, 0xFF, 0xFF, 0xFF, 1, 2, 3, 4},  // 2 GiB
      {0x82, 0x02, 1, 2},
      maskedFrame(0x81, {'{', '}'}),
      maskedFrame(0xC2, {1, 2}),
      maskedFrame(0x09, {1}),
      maskedFrame(0x80, {1}),
      maskedFrame(0x82, {0xFF, 0xFF, 0xFF})};
  for (const Bytes& each : wrong) {
    RawPeer peer(io, server.port());
    peer.send(toBytes(upgrade(server)));
    peer.send(each);
    ASSERT_TRUE(runUntil([&] {
      peer.poll();
      return peer.closed;
    }));
    EXPECT_FALSE(peer.reset);
    server.publish(++id);
    ASSERT_TRUE(receives<CodedFrame>(*tcp, id));
    ASSERT_TRUE((gets<Viewer, CodedFrame>(*web, id)));
  }
  RawPeer flood(io, server.port());
  flood.send(toBytes(upgrade(server)));
  for (std::size_t i = 0; i < 1000; ++i) flood.send(maskedFrame(i == 0 ? 0x02 : 0x00, {1}));
  ASSERT_TRUE(runUntil([&] {
    flood.poll();
    return flood.closed;
  }));
  EXPECT_EQ(server.broadcaster.counts().refused, wrong.size() + 1);
  EXPECT_THAT(log.text(), HasSubstr("a length of 2^63 or more"));
  EXPECT_EQ(server.broadcaster.counts().clients, 2U);
}

TEST_F(WebSocketTest, HalfOpenUpgradesKeepNoViewerOut) {
  constexpr int kUpgrades = 10'000;
  TestServer server(io, clock);
  const auto before = viewer(server);
  const std::string whole = upgrade(server);
  std::vector<std::unique_ptr<RawPeer>> open;
  std::size_t most = 0;
  for (int i = 0; i < kUpgrades; ++i) {
    open.push_back(std::make_unique<RawPeer>(io, server.port()));
    open.back()->send(toBytes(i % 2 == 0 ? whole : whole.substr(0, whole.size() / 2)));
    if (i % 100 != 99) continue;
    for (int turns = 0; turns < 2; ++turns) turn();
    std::erase_if(open, [](const auto& each) {
      each->poll();
      return each->closed;
    });
    most = std::max(most, open.size());
  }
  EXPECT_LE(most, server::Broadcaster::kMaxPending + 1);
  server.publish(1);
  EXPECT_TRUE(receives<CodedFrame>(*before));
  const auto web = browser(server);
  EXPECT_TRUE((gets<Viewer, CodedFrame>(*web)));
}

TEST_F(WebSocketTest, AnOperatorLearnsTheNumberOfViewers) {
  TestServer server(io, clock);
  const std::string digest_of_a =
      "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb";
  const std::string digest_of_b =
      "3e23e8160039594a33894f6564e1b1348bbd7a0088d42c4acb73eeaed59c009d";
  server.broadcaster.setAccess(
      server::AccessList::parse(digest_of_a + " operator never\n" + digest_of_b + " viewer never\n")
          .value());
  std::optional<Control> request;
  server.broadcaster.onControl([&](const Control& control, const std::function<void()>& confirm) {
    request = control;
    confirm();
  });
  turn();
  Viewer boss(io, server.port()), guest(io, server.port());
  boss.send(Hello{kProtocolVersion, "boss", false, true, "a"});
  guest.send(Hello{kProtocolVersion, "guest", false, true, "b"});
  ASSERT_TRUE((gets<Viewer, Welcome>(boss)));
  ASSERT_TRUE((gets<Viewer, Welcome>(guest)));
  boss.send(Control{{}, {}, {}, {}, 99U});
  ASSERT_TRUE((gets<Viewer, Control>(boss)));
  EXPECT_EQ(request, std::nullopt) << "an empty request asks for the number alone";
  EXPECT_EQ(boss.all<Control>()[0].viewers, 2U);
  boss.send(Control{true, {}, {}, {}, 99U});
  ASSERT_TRUE((gets<Viewer, Control>(boss, 2)));
  EXPECT_EQ(request, (Control{true, {}, {}}));
  EXPECT_EQ(boss.all<Control>()[1], (Control{true, {}, {}, {}, 2U}));
  guest.send(Control{});
  ASSERT_TRUE((gets<Viewer, Control>(guest)));
  EXPECT_EQ(guest.all<Control>()[0], Control{}) << "a viewer gets no number";
  guest.send(Control{true, {}, {}});
  ASSERT_TRUE(ends(guest));
  EXPECT_EQ(guest.all<WireError>()[0].code, ErrorCode::kForbidden);
}

TEST_F(WebSocketTest, ATokenWithoutTlsComesFromThisMachineOnly) {
  TestServer server(io, clock);
  server.broadcaster.setAccess(
      server::AccessList::parse(
          "ca978112ca1bbdcafac231b39a23dc4da786eff8147c4e72b9807785afee48bb viewer never\n")
          .value());
  turn();
  const std::string port = ":" + std::to_string(server.port());
  Viewer here(io, server.port(), {.host = "localhost" + port});
  here.send(Hello{kProtocolVersion, "here", false, true, "a"});
  EXPECT_TRUE((gets<Viewer, Welcome>(here)));
  Viewer by_proxy(io, server.port(), {.host = "192.0.2.7" + port});
  by_proxy.send(Hello{kProtocolVersion, "by a proxy", false, true, "a"});
  ASSERT_TRUE(ends(by_proxy));
  ASSERT_EQ(by_proxy.all<WireError>().size(), 1U);
  EXPECT_EQ(by_proxy.all<WireError>()[0].message, "this server needs TLS: open its page by https");
}

TEST_F(WebSocketTest, WorksInsideTls) {
  const auto context = TlsContext::ofServer(makeTlsIdentity());
  TestServer server(io, clock, {}, 0, "127.0.0.1", context.value());
  asio::ssl::context trust(asio::ssl::context::tls_client);
  TlsViewer web(io, server.port(), {.scheme = "https://"}, trust);
  web.send(Hello{kProtocolVersion, "browser", false, true});
  ASSERT_TRUE((gets<TlsViewer, Welcome>(web))) << web.error.message();
  const auto tcp = viewer(server);
  tcp->keeps_payloads = true;
  for (std::uint64_t id = 1; id <= 10; ++id) {
    server.publish(id, id % 5 == 0 ? 300 : 8);
    ASSERT_TRUE(receives<CodedFrame>(*tcp, id));
    ASSERT_TRUE((gets<TlsViewer, CodedFrame>(web, id)));
  }
  EXPECT_EQ(selectFrames(web.payloads), selectFrames(tcp->payloads));
  TlsViewer of_http(io, server.port(), {.scheme = "http://"}, trust);
  ASSERT_TRUE(runUntil([&] { return of_http.ended; }));
  EXPECT_EQ(of_http.response.result_int(), 403U);
  server.stop();
  ASSERT_TRUE(runUntil([&] { return web.ended; }));
  EXPECT_EQ(web.close_code, 1000);
}

TEST_F(WebSocketTest, AnotherVersionGetsOneSentence) {
  const LogLines log;
  TestServer server(io, clock);
  const Viewer newer(io, server.port(), {.protocol = "hapticast.4"});
  ASSERT_TRUE(ends(newer));
  EXPECT_EQ(newer.response.result_int(), 400U);
  EXPECT_THAT(log.text(), HasSubstr("This server speaks hapticast.3, the page hapticast.4"));
}

}  // namespace
}  // namespace hapticast::testing
