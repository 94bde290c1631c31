// SPDX-License-Identifier: MIT
// The client as a user runs it, and malicious servers over TCP, by datagrams and to a group:
// the logged force keeps the limits, and the client reports the cause.
#include <thread>

#include "tests/integration/malicious_fixture.hpp"
#include "tests/integration/stream_fixture.hpp"
#include "tests/scenes/false_streams/malicious_server.hpp"
#include "tests/support/datagram_bytes.hpp"

namespace hapticast::testing {
namespace {

/// Sends one false stream to each viewer, one viewer at a time.
class MaliciousListener {
 public:
  explicit MaliciousListener(const FalseStream& false_stream)
      : server_(false_stream),
        acceptor_(io_, {asio::ip::address_v4::loopback(), 0}),
        udp_(io_, {asio::ip::address_v4::loopback(), 0}),
        group_(asio::ip::make_address("239.255.75.1"), udp_.local_endpoint().port()) {
    udp_.non_blocking(true);
    udp_.set_option(asio::ip::multicast::outbound_interface(asio::ip::address_v4::loopback()));
    server_.offers(udp_.local_endpoint().port(),
                   {group_.address().to_string(), group_.port(), MaliciousServer::kToken});
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  [[nodiscard]] std::string address() const {
    return "127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }

 private:
  void run(const std::stop_token& stop) {
    acceptor_.non_blocking(true);
    while (!stop.stop_requested()) {
      boost::system::error_code none;
      asio::ip::tcp::socket socket(io_);
      acceptor_.accept(socket, none);
      if (none) {
        restBetweenTurns();
        continue;
      }
      RawPeer viewer(std::move(socket));
      talk(viewer, stop);
    }
  }
  void talk(RawPeer& viewer, const std::stop_token& stop) {
    while (viewer.all<Hello>().empty() && !viewer.closed && !stop.stop_requested()) {
      viewer.poll();
      restBetweenTurns();
    }
    viewer.got.clear();
    viewer.send(framed(server_.welcome()));
    const LocalTime begin = clock_.now();
    while (!viewer.closed && !stop.stop_requested()) {
      viewer.poll();
      const double now_s = secondsSince(begin);
      for (const Ping& ping : viewer.all<Ping>()) {
        if (const auto answer = server_.answer(ping, now_s)) viewer.send(framed(*answer));
      }
      viewer.got.clear();
      for (const Bytes& message : server_.messages(now_s)) viewer.send(framed(message));
      if (server_.byDatagrams()) sendDatagrams();
      restBetweenTurns();
    }
  }
  /// To whoever echoes, and to the group; a probe now and then as an honest server sends it.
  void sendDatagrams() {
    std::array<std::uint8_t, kEchoBytes> echo{};
    boost::system::error_code none;
    for (;;) {
      asio::ip::udp::endpoint from;
      (void)udp_.receive_from(asio::buffer(echo), from, 0, none);
      if (none == asio::error::would_block) break;
      if (!none) viewer_at_ = from;
    }
    std::vector<Bytes> bodies = server_.takeDatagrams();
    if (++turns_ % 100 == 1) bodies.push_back(server_.probe());
    for (const Bytes& body : bodies) {
      const Bytes bytes = datagramBytes(MaliciousServer::kToken, body);
      if (viewer_at_) udp_.send_to(asio::buffer(bytes), *viewer_at_, 0, none);
      udp_.send_to(asio::buffer(bytes), group_, 0, none);
    }
  }
  [[nodiscard]] double secondsSince(LocalTime begin) const {
    return toSeconds(clock_.now() - begin);
  }

  SteadyClock clock_;
  asio::io_context io_;
  MaliciousServer server_;
  asio::ip::tcp::acceptor acceptor_;
  asio::ip::udp::socket udp_;
  asio::ip::udp::endpoint group_;
  std::optional<asio::ip::udp::endpoint> viewer_at_;
  std::uint64_t turns_ = 0;
  std::jthread thread_;  // last: it uses the others
};

/// Each client at a server of its own.
class ProgramsMaliciousServerTest : public ProgramsMaliciousTest {
 protected:
  void runAll(std::span<const ExpectedMessage> expected) {
    runFalseStreams(expected, [this](const FalseStream& false_stream) {
      return servers_.emplace_back(std::make_unique<MaliciousListener>(false_stream))->address();
    });
  }

 private:
  std::vector<std::unique_ptr<MaliciousListener>> servers_;
};

TEST_F(ProgramsMaliciousServerTest, AreLimitedAndReportedToTheUser) {
  runAll(std::to_array<ExpectedMessage>({
      {"acceleration_1e8_described", "the client does not trust the stream any more"},
      {"acc_square_4hz_x", "no force from now on; restart the client"},
      {"clock_of_another_origin", "another server makes the stream from now on"},
      {"id_max_once", "jumps of the frame ids"},
      {"outside", "whose objects are not shown"},
      {"silence", "no new frames arrive: the force has faded"},
      {"stiffness_1000", "a wall is softer than the stream asks for"},
      {"structure_cut", "trying again"},
  }));
}

TEST_F(ProgramsMaliciousServerTest, InDatagramsAreLimitedToo) {
  runAll(std::to_array<ExpectedMessage>({
      {"datagram_ids_max_first", "", "udp"},
      {"datagram_copies_contradict_in_turns", "", "udp"},
      {"datagram_half_sent", "", "udp"},
      {"datagram_probes", "", "udp"},
      {"datagram_times_against_tcp", "", "udp"},
  }));
}

TEST_F(ProgramsMaliciousServerTest, ToTheGroupAreLimitedToo) {
  runAll(std::to_array<ExpectedMessage>({
      {"datagram_honest", "", "multicast"},
      {"datagram_epoch_against_tcp", "", "multicast"},
      {"datagram_copies_contradict_in_turns", "", "multicast"},
      // A client that joins the group after the noise began has shown no frame before.
      {"datagram_noise", "frames arrive: the", "multicast"},
      {"datagram_ids_race", "", "multicast"},
  }));
}

}  // namespace
}  // namespace hapticast::testing
