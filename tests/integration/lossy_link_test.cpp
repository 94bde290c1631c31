// SPDX-License-Identifier: MIT
// The bad network of the tests, in this program and as hapticast-link, between peers and an echo.
#include "tests/support/lossy_link.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <set>
#include <string>

#include "tests/support/process.hpp"

namespace hapticast::testing {
namespace {

using asio::ip::tcp;
using asio::ip::udp;
using std::chrono::milliseconds;

/// Sends back what comes, by TCP and by UDP on the same port.
struct Echo {
  Echo(asio::io_context& io, const asio::ip::address& address)
      : acceptor(io, {address, 0}), socket(io), datagrams(io) {
    datagrams.open(acceptor.local_endpoint().protocol() == tcp::v6() ? udp::v6() : udp::v4());
    datagrams.bind({address, acceptor.local_endpoint().port()});
    acceptor.async_accept(socket, [this](const boost::system::error_code& ec) {
      if (!ec) echo();
    });
    echoDatagrams();
  }
  void echo() {
    socket.async_read_some(asio::buffer(stream),
                           [this](const boost::system::error_code& ec, std::size_t size) {
                             if (ec) return;
                             asio::write(socket, asio::buffer(stream, size));
                             echo();
                           });
  }
  void echoDatagrams() {
    datagrams.async_receive_from(asio::buffer(datagram), from,
                                 [this](const boost::system::error_code& ec, std::size_t size) {
                                   if (ec) return;
                                   seen.insert(from);
                                   datagrams.send_to(asio::buffer(datagram, size), from);
                                   echoDatagrams();
                                 });
  }
  tcp::acceptor acceptor;
  tcp::socket socket;
  udp::socket datagrams;
  std::array<char, 65536> stream{}, datagram{};
  udp::endpoint from;
  std::set<udp::endpoint> seen;  // who has sent datagrams
};

/// Sends datagrams and keeps what comes.
struct Peer {
  Peer(asio::io_context& io, const udp::endpoint& to) : socket(io, to.protocol()) {
    socket.connect(to);
    socket.non_blocking(true);
  }
  void send(const std::string& text) { socket.send(asio::buffer(text)); }
  std::size_t poll() {
    std::array<char, 65536> buffer{};
    boost::system::error_code ec;
    for (;;) {
      const std::size_t size = socket.receive(asio::buffer(buffer), 0, ec);
      if (ec) return got.size();
      got.emplace_back(buffer.data(), size);
    }
  }
  udp::socket socket;
  std::vector<std::string> got;
};

class LossyLinkTest : public ::testing::Test {
 protected:
  bool runUntil(const std::function<bool()>& done) {
    return waitUntil(std::chrono::seconds(60), [&] {
      io.restart();
      io.poll();
      return done();
    });
  }
  static udp::endpoint at(std::uint16_t port) { return {asio::ip::address_v4::loopback(), port}; }

  asio::io_context io;
};

TEST_F(LossyLinkTest, DatagramsOfEachPeerComeFromAPortOfItsOwn) {
  Echo echo(io, asio::ip::address_v4::loopback());
  LossyLink link(io, echo.acceptor.local_endpoint().port(), {});
  Peer one(io, at(link.port())), other(io, at(link.port()));
  one.send("one");
  other.send("other");
  ASSERT_TRUE(runUntil([&] { return one.poll() == 1 && other.poll() == 1; }));
  EXPECT_EQ(one.got[0], "one");
  EXPECT_EQ(other.got[0], "other");
  EXPECT_EQ(echo.seen.size(), 2U);
  link.cut();
  one.send("again");
  ASSERT_TRUE(runUntil([&] { return one.poll() == 2; }));
  EXPECT_EQ(echo.seen.size(), 3U) << "as behind a router that has forgotten it";
}

TEST_F(LossyLinkTest, AppliesTheRequestedFaultsToDatagrams) {
  Echo echo(io, asio::ip::address_v4::loopback());
  LossyLink link(io, echo.acceptor.local_endpoint().port(), {.delay = milliseconds(10)});
  Peer peer(io, at(link.port()));
  const auto begin = std::chrono::steady_clock::now();
  peer.send("x");
  ASSERT_TRUE(runUntil([&] { return peer.poll() == 1; }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(20));
  link.up().profile.duplicate = 1.0;
  peer.send("twice");
  ASSERT_TRUE(runUntil([&] { return peer.poll() == 3; }));
  link.up().profile.duplicate = 0.0;
  link.up().profile.largest_bytes = 3;
  peer.send("long");
  ASSERT_TRUE(runUntil([&] { return link.up().counts.too_large == 1; }));
  link.up().profile.largest_bytes = 65535;
  link.stall(true);
  peer.send("lost");
  ASSERT_TRUE(runUntil([&] { return link.up().counts.stalled == 1; }));
  link.stall(false);
  link.down().profile.loss = 1.0;
  peer.send("lost, too");
  ASSERT_TRUE(runUntil([&] { return link.down().counts.lost == 1; }));
  link.down().profile.loss = 0.0;
  peer.send("end");
  ASSERT_TRUE(runUntil([&] { return peer.poll() > 0 && peer.got.back() == "end"; }));
  EXPECT_EQ(peer.got.size(), 4U);
}

TEST_F(LossyLinkTest, TheRateAppliesToStreams) {
  Echo echo(io, asio::ip::address_v4::loopback());
  LossyLink link(io, echo.acceptor.local_endpoint().port(),
                 {.rate_bits_s = 8e6, .queue_bytes = 20000});
  tcp::socket peer(io);
  peer.connect({asio::ip::address_v4::loopback(), link.port()});
  peer.non_blocking(true);
  const std::vector<char> sent(100000, 'x');
  std::size_t got = 0;
  std::vector<char> buffer(sent.size());
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(asio::write(peer, asio::buffer(sent)), sent.size());
  ASSERT_TRUE(runUntil([&] {
    boost::system::error_code ec;
    got += peer.read_some(asio::buffer(buffer), ec);
    return got == sent.size();
  }));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(100));
  EXPECT_EQ(link.up().counts.bytes, sent.size());
}

TEST_F(LossyLinkTest, WorksWithIpv6) {
  boost::system::error_code ec;
  tcp::acceptor probe(io);
  probe.open(tcp::v6(), ec);
  if (!ec) probe.bind({asio::ip::address_v6::loopback(), 0}, ec);
  if (ec) GTEST_SKIP() << "no IPv6 on this machine";
  Echo echo(io, asio::ip::address_v6::loopback());
  LossyLink link(io, {asio::ip::address_v6::loopback(), 0}, echo.acceptor.local_endpoint(), {}, {});
  Peer peer(io, {asio::ip::address_v6::loopback(), link.port()});
  peer.send("six");
  EXPECT_TRUE(runUntil([&] { return peer.poll() == 1; }));
}

/// hapticast-link itself.
TEST_F(LossyLinkTest, TheProgramRelaysAndReportsItsCounts) {
  Echo echo(io, asio::ip::address_v4::loopback());
  const std::string server = "127.0.0.1:" + std::to_string(echo.acceptor.local_endpoint().port());
  Process program({HAPTICAST_LINK_PROGRAM, "--listen", "127.0.0.1:0", "--server", server, "--delay",
                   "5", "--duplicate", "1", "--largest", "100"});
  ASSERT_TRUE(program.says("Ctrl-C ends it", std::chrono::seconds(60))) << program.output();
  const std::string line = program.output();
  const std::size_t colon = line.find(':');
  const auto port = static_cast<std::uint16_t>(std::stoi(line.substr(colon + 1)));
  Peer peer(io, at(port));
  tcp::socket stream(io);
  stream.connect({asio::ip::address_v4::loopback(), port});
  asio::write(stream, asio::buffer(std::string("hello")));
  stream.non_blocking(true);
  peer.send(std::string(101, 'x'));
  peer.send("small");
  std::string echoed;
  ASSERT_TRUE(runUntil([&] {
    std::array<char, 100> buffer{};
    boost::system::error_code ec;
    echoed.append(buffer.data(), stream.read_some(asio::buffer(buffer), ec));
    return peer.poll() == 4 && echoed == "hello";
  })) << program.output();
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(std::chrono::seconds(60)), 0);
  EXPECT_NE(program.output().find("in all: up: 3 packets, 0 kB, 1 too large, 1 doubled"),
            std::string::npos)
      << program.output();
}

TEST_F(LossyLinkTest, TheProgramRefusesWrongFlagsInOneLine) {
  const std::vector<std::vector<std::string>> wrong = {
      {"--loss", "1.5"}, {"--distribution", "gauss"}, {"--listen", "here:x"}, {"--dely", "5"}};
  for (const auto& flags : wrong) {
    Process program({HAPTICAST_LINK_PROGRAM, flags[0], flags[1]});
    EXPECT_EQ(program.wait(std::chrono::seconds(60)), 2);
    EXPECT_EQ(countOccurrences("\n", program.output()), 1U) << program.output();
    EXPECT_NE(program.output().find(flags[0]), std::string::npos) << program.output();
  }
}

}  // namespace
}  // namespace hapticast::testing
