// SPDX-License-Identifier: MIT
// The stream by UDP, over loopback: who gets it, what arrives, and who gets nothing.
#include <set>

#include "server/stream/stream_settings.hpp"
#include "tests/integration/datagram_fixture.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/datagram_viewer.hpp"

namespace hapticast::testing {
namespace {

class DatagramsTest : public StreamTest {
 protected:
  static asio::ip::udp::endpoint at(const char* host, std::uint16_t port = 0) {
    return {asio::ip::make_address(host), port};
  }
  /// A viewer by UDP, with its TCP connection.
  struct Viewer {
    std::unique_ptr<RawPeer> tcp;
    Welcome welcome;
    DatagramViewer udp;
  };
  std::unique_ptr<Viewer> viewerOf(const DatagramServer& server) {
    auto tcp = viewer(server);
    const Welcome welcome = tcp->all<Welcome>().at(0);
    const std::uint16_t port = welcome.datagram_port != 0 ? welcome.datagram_port : server.port();
    return std::unique_ptr<Viewer>(
        new Viewer{std::move(tcp), welcome, {io, welcome, at("127.0.0.1"), at("127.0.0.1", port)}});
  }
  /// One that has had its probe.
  std::unique_ptr<Viewer> takerOf(const DatagramServer& server) {
    auto viewer = viewerOf(server);
    viewer->udp.echo();
    EXPECT_TRUE(runUntil([&] {
      viewer->udp.poll();
      return viewer->udp.probes == 1;
    }));
    return viewer;
  }
  /// Publishes frames until `done`, each of which every viewer of `takers` has whole before the
  /// next is made.
  void publishTo(DatagramServer& server, const std::vector<Viewer*>& takers, std::uint64_t id,
                 int side = 8) {
    server.publish(id, side);
    for (Viewer* each : takers) {
      EXPECT_TRUE(runUntil([&] {
        each->udp.poll();
        return !each->udp.frames.empty() && each->udp.frames.back().id == id;
      })) << "frame "
          << id << " did not come";
    }
  }
};

TEST_F(DatagramsTest, AFrameArrivesAsItWasSent) {
  DatagramServer server(io, clock);
  const auto viewer = takerOf(server);
  EXPECT_EQ(viewer->welcome.datagram_port, 0) << "the TCP port's number";
  EXPECT_EQ(viewer->udp.froms.at(0).port(), server.port());
  publishTo(server, {viewer.get()}, 5, 220);
  const CodedFrame& frame = viewer->udp.frames.at(0);
  EXPECT_EQ(frame.epoch, 3U);
  EXPECT_EQ(frame.media_time, server.last.media_time);
  ASSERT_TRUE(frame.objects.at(0).relief);
  EXPECT_TRUE(frame.objects[0].relief->whole());
  EXPECT_EQ(decodedRelief(*frame.objects[0].relief).mask, server.last.objects[0].relief->mask);
  EXPECT_GT(viewer->udp.seen.at(5).size(), 50U) << "as many datagrams as noise needs";
  EXPECT_EQ(viewer->udp.refused, 0U);
  EXPECT_EQ(server.sender->counts().viewers.sent, viewer->udp.seen.at(5).size());
}

TEST_F(DatagramsTest, AllViewersGetTheSameBytesWithTheirOwnTokens) {
  DatagramServer server(io, clock);
  std::vector<std::unique_ptr<Viewer>> viewers;
  std::vector<Viewer*> takers;
  std::set<std::uint64_t> tokens{0};
  for (int i = 0; i < 20; ++i) {
    viewers.push_back(takerOf(server));
    takers.push_back(viewers.back().get());
    EXPECT_TRUE(tokens.insert(viewers.back()->welcome.datagram_token).second);
  }
  for (std::uint64_t id = 1; id <= 10; ++id) publishTo(server, takers, id, id == 5 ? 220 : 8);
  for (const auto& each : viewers) {
    EXPECT_EQ(each->udp.frames.size(), 10U);
    EXPECT_EQ(each->udp.refused, 0U);
  }
}

TEST_F(DatagramsTest, MakesNoDatagramsWithoutSubscribers) {
  DatagramServer server(io, clock);
  auto viewer = viewerOf(server);
  EXPECT_FALSE(server.broadcaster.datagramsWanted()) << "it has not echoed";
  viewer->udp.echo();
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.datagramsWanted(); }));
  viewer->tcp->send(Delivery{true, false, 1});
  ASSERT_TRUE(runUntil([&] { return !server.broadcaster.datagramsWanted(); }));
  viewer->tcp->send(Delivery{true, true, 1});
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.datagramsWanted(); }));
  viewer.reset();
  EXPECT_TRUE(runUntil([&] { return !server.broadcaster.datagramsWanted(); })) << "it has left";
}

TEST_F(DatagramsTest, DeliverySwitchesBetweenTcpAndDatagrams) {
  DatagramServer server(io, clock);
  const auto viewer = takerOf(server);
  const auto tcpHas = [&](std::uint64_t id) {
    return runUntil([&] {
      viewer->tcp->poll();
      const auto frames = viewer->tcp->all<CodedFrame>();
      return !frames.empty() && frames.back().id == id;
    });
  };
  publishTo(server, {viewer.get()}, 1);
  EXPECT_TRUE(tcpHas(1)) << "both until it says otherwise";
  viewer->tcp->send(Delivery{false, true, 1});
  viewer->tcp->send(Ping{});
  ASSERT_TRUE(runUntil([&] {
    viewer->tcp->poll();
    return !viewer->tcp->all<Pong>().empty();
  }));
  publishTo(server, {viewer.get()}, 2);
  viewer->tcp->send(Delivery{true, false, 1});
  ASSERT_TRUE(runUntil([&] { return !server.broadcaster.datagramsWanted(); }));
  server.publish(3);
  EXPECT_TRUE(tcpHas(3));
  EXPECT_EQ(viewer->tcp->all<CodedFrame>().size(), 2U) << "the second came by UDP alone";
  EXPECT_EQ(viewer->udp.frames.size(), 2U);
}

TEST_F(DatagramsTest, AfterASwitchToTcpTheFirstFrameIsWhole) {
  DatagramServer server(io, clock);
  const auto viewer = takerOf(server);
  const auto publishStill = [&](std::uint64_t id) {
    HapticFrame frame;
    frame.id = id;
    frame.media_time = mediaTime(0.01 * static_cast<double>(id));
    frame.objects.push_back({1, 0, 1, server.noise(8), {}, nullptr, {}, {}});
    server.broadcaster.publish(server.encoder.encode(frame, {}, &server.signer));
  };
  const auto last = [&](std::uint64_t id) {
    EXPECT_TRUE(runUntil([&] {
      viewer->tcp->poll();
      return !viewer->tcp->all<CodedFrame>().empty() &&
             viewer->tcp->all<CodedFrame>().back().id == id;
    }));
    return viewer->tcp->all<CodedFrame>().back();
  };
  publishStill(1);
  EXPECT_TRUE(last(1).objects[0].relief);
  publishStill(2);
  EXPECT_FALSE(last(2).objects[0].relief) << "unchanged";
  viewer->tcp->send(Delivery{false, true, 1});
  viewer->tcp->send(Delivery{true, false, 1});
  ASSERT_TRUE(runUntil([&] { return !server.broadcaster.datagramsWanted(); }));
  publishStill(3);
  EXPECT_TRUE(last(3).objects[0].relief) << "what came meanwhile may be lost";
}

TEST_F(DatagramsTest, CopiesGoOutWithTheFramesAfter) {
  DatagramServer server(io, clock);
  const auto once = takerOf(server);
  const auto thrice = takerOf(server);
  thrice->tcp->send(Delivery{false, true, 3});
  thrice->tcp->send(Ping{});
  ASSERT_TRUE(runUntil([&] {
    thrice->tcp->poll();
    return !thrice->tcp->all<Pong>().empty();
  }));
  for (std::uint64_t id = 1; id <= 6; ++id) publishTo(server, {once.get(), thrice.get()}, id);
  ASSERT_TRUE(runUntil([&] {
    thrice->udp.poll();
    return thrice->udp.seen.at(4)[0] == 3;
  }));
  for (std::uint64_t id = 1; id <= 4; ++id) EXPECT_EQ(thrice->udp.seen.at(id)[0], 3) << id;
  EXPECT_EQ(thrice->udp.seen.at(5)[0], 2);
  EXPECT_EQ(thrice->udp.seen.at(6)[0], 1);
  once->udp.poll();
  for (std::uint64_t id = 1; id <= 6; ++id) EXPECT_EQ(once->udp.seen.at(id)[0], 1) << id;
}

TEST_F(DatagramsTest, AViewerCannotDirectTheStreamToAnotherHost) {
  DatagramServer server(io, clock);
  const auto honest = takerOf(server);
  const auto victim_of = viewerOf(server);  // has not echoed
  const std::uint16_t port = server.port();
  DatagramViewer elsewhere(io, victim_of->welcome, at("127.0.0.2"), at("127.0.0.1", port));
  elsewhere.echo();  // the token is right, the host is not
  DatagramViewer guesser(io, honest->welcome, at("127.0.0.1"), at("127.0.0.1", port));
  guesser.echo(honest->welcome.datagram_token + 1);
  guesser.echo(0);
  guesser.send(std::vector<std::uint8_t>(1232, 7));
  guesser.send(std::vector<std::uint8_t>{});
  ASSERT_TRUE(runUntil([&] {
    return server.echoes(server::AddressValidation::kForeign) == 1 &&
           server.echoes(server::AddressValidation::kUnknownToken) == 2 &&
           server.echoes(server::AddressValidation::kMalformed) == 2;
  }));
  for (std::uint64_t id = 1; id <= 20; ++id) publishTo(server, {honest.get()}, id);
  for (DatagramViewer* each : {&elsewhere, &guesser, &victim_of->udp}) {
    each->poll();
    EXPECT_TRUE(each->froms.empty()) << "not a single byte";
  }
}

TEST_F(DatagramsTest, AHundredPortsAndAFloodGetOneProbe) {
  DatagramServer server(io, clock);
  const auto honest = takerOf(server);
  const auto viewer = viewerOf(server);
  std::vector<std::unique_ptr<DatagramViewer>> ports;
  for (int i = 0; i < 100; ++i) {
    ports.push_back(std::make_unique<DatagramViewer>(io, viewer->welcome, at("127.0.0.1"),
                                                     at("127.0.0.1", server.port())));
    ports.back()->echo();
  }
  for (int i = 0; i < 2000; ++i) ports[0]->echo(1);  // more than are read in one go
  ASSERT_TRUE(
      runUntil([&] { return server.echoes(server::AddressValidation::kUnknownToken) > 0; }));
  publishTo(server, {honest.get()}, 1);
  std::size_t datagrams = 0;
  std::size_t takers = 0;
  for (const auto& each : ports) {
    each->poll();
    datagrams += each->froms.size();
    takers += each->seen.empty() ? 0 : 1;
  }
  EXPECT_LE(takers, 1U) << "frames go to one port";
  // 101 echoes within a moment; where the machine dreams, two of them may be 0.1 s apart.
  const std::uint64_t validated = server.echoes(server::AddressValidation::kValidated) - 1;
  EXPECT_GE(validated, 1U);
  EXPECT_LE(datagrams, validated + server.sender->counts().viewers.sent);
  EXPECT_GT(server.echoes(server::AddressValidation::kTooSoon), 0U);
}

TEST_F(DatagramsTest, AnotherPortIsNamedWhereTheNumberIsTaken) {
  TestServer first(io, clock);
  asio::ip::udp::socket taken(io, at("127.0.0.1", first.port()));
  server::FrameSigner signer;
  server::DatagramSender sender(io, clock, first.listener.endpoint(), signer.identity());
  first.broadcaster.introduce(signer.identity());
  first.broadcaster.enableUdp(sender);
  const auto tcp = viewer(first);
  const Welcome welcome = tcp->all<Welcome>().at(0);
  ASSERT_NE(welcome.datagram_port, 0);
  EXPECT_NE(welcome.datagram_port, first.port());
  DatagramViewer udp(io, welcome, at("127.0.0.1"), at("127.0.0.1", welcome.datagram_port));
  udp.echo();
  EXPECT_TRUE(runUntil([&] {
    udp.poll();
    return udp.probes == 1;
  }));
}

TEST_F(DatagramsTest, WithoutASenderThereIsNoOffer) {
  TestServer server(io, clock);
  const auto tcp = viewer(server);
  EXPECT_EQ(tcp->all<Welcome>().at(0).datagram_token, 0U);
  tcp->send(Delivery{true, true, 4});
  tcp->send(Ping{});
  EXPECT_TRUE(receives<Pong>(*tcp)) << "it may say so all the same";
}

/// Which addresses a server listens on, and one that viewers come to.
struct Listening {
  const char* server;
  const char* viewer;
  const char* to;
};

class DatagramsAddressesTest : public DatagramsTest,
                               public ::testing::WithParamInterface<Listening> {};

TEST_P(DatagramsAddressesTest, DatagramsLeaveFromWhereTheConnectionCameTo) {
  const Listening& way = GetParam();
  DatagramServer server(io, clock, std::nullopt, way.server);
  RawPeer tcp(io, {asio::ip::make_address(way.to), server.port()},
              asio::ip::make_address(way.viewer));
  tcp.send(Hello{kProtocolVersion, "raw", false, false});
  ASSERT_TRUE(receives<Welcome>(tcp));
  DatagramViewer udp(io, tcp.all<Welcome>()[0], at(way.viewer), at(way.to, server.port()));
  udp.echo();
  ASSERT_TRUE(runUntil([&] {
    udp.poll();
    return udp.probes == 1;
  }));
  server.publish(1);
  ASSERT_TRUE(runUntil([&] {
    udp.poll();
    return udp.frames.size() == 1;
  }));
  for (const auto& from : udp.froms) EXPECT_EQ(from, at(way.to, server.port()));
  EXPECT_TRUE(tcp.all<CodedFrame>().empty()) << "its hello wanted none by TCP";
}

INSTANTIATE_TEST_SUITE_P(All, DatagramsAddressesTest,
                         ::testing::Values(Listening{"0.0.0.0", "127.0.0.1", "127.0.0.1"},
                                           Listening{"0.0.0.0", "127.0.0.5", "127.0.0.9"},
                                           Listening{"::", "::1", "::1"},
                                           Listening{"::", "127.0.0.5", "127.0.0.9"},
                                           Listening{"::1", "::1", "::1"}));

TEST_F(DatagramsTest, TheGroupGetsEachDatagramOnce) {
  const auto choice = loopbackGroup("239.255.77.1");
  DatagramServer server(io, clock, choice);
  const auto first = viewer(server);
  const auto second = viewer(server);
  const Welcome welcome = first->all<Welcome>().at(0);
  ASSERT_TRUE(welcome.group);
  EXPECT_EQ(welcome.group->address, "239.255.77.1");
  EXPECT_EQ(welcome.group->token, second->all<Welcome>().at(0).group->token);
  EXPECT_NE(welcome.group->token, welcome.datagram_token);
  EXPECT_TRUE(server.broadcaster.datagramsWanted()) << "viewers may listen without a word";
  DatagramViewer one(io, welcome, at("239.255.77.1", choice.group.port),
                     at("127.0.0.1", server.port()));
  one.join(asio::ip::make_address("127.0.0.1"));
  for (RawPeer* each : {first.get(), second.get()}) {
    each->send(Delivery{false, false, 2});
    each->send(Ping{});
    ASSERT_TRUE(receives<Pong>(*each));
  }
  for (std::uint64_t id = 1; id <= 4; ++id) {
    server.publish(id, id == 2 ? 220 : 8);
    ASSERT_TRUE(runUntil([&] {
      one.poll();
      return one.frames.size() == id;
    }));
  }
  ASSERT_TRUE(runUntil([&] {
    one.poll();
    return one.seen.at(3)[0] == 2;
  }));
  for (const auto& [part, times] : one.seen.at(2)) EXPECT_EQ(times, 2) << part;
  EXPECT_EQ(one.refused, 0U);
  EXPECT_EQ(server.sender->counts().viewers.sent, 0U);
  EXPECT_EQ(server.sender->counts().group.sent, one.froms.size() - one.probes);
  EXPECT_GE(one.probes, 1U) << "who joins learns whether full size gets through";
}

TEST_F(DatagramsTest, ReportsAnImpossibleGroupInOneLine) {
  const auto complaint = [&](const server::MulticastChoice& choice) -> std::string {
    try {
      server::MulticastGroup group(io, choice, 1);
    } catch (const AddressError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint({{"239.255.77.1", 7449}, "lo"}), "");
  EXPECT_EQ(complaint({{"239.255.77.1", 7449}, "127.0.0.1"}), "");
  EXPECT_NE(complaint({{"239.255.77.1", 7449}, "nosuch0"})
                .find("--multicast 239.255.77.1:7449: this machine has no network 'nosuch0'; its "
                      "networks are "),
            std::string::npos);
  EXPECT_NE(complaint({{"127.0.0.1", 7449}, ""}).find("is not a multicast address"),
            std::string::npos);
}

}  // namespace
}  // namespace hapticast::testing
