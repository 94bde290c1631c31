// SPDX-License-Identifier: MIT
// The false streams of the tests pass from a malicious origin through nats-server and a real edge
// to real clients, with the same result as from a malicious server.
#include <thread>

#include "common/build_options.hpp"
#include "common/protocol/relay.hpp"
#include "common/time.hpp"
#include "server/relay/nats_connection.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/subjects.hpp"
#include "tests/integration/malicious_fixture.hpp"
#include "tests/support/nats_server.hpp"

namespace hapticast::testing {
namespace {

/// Sends one false stream to all edges of a channel. Its signatures and heads are those of an
/// honest origin.
class MaliciousOrigin {
 public:
  MaliciousOrigin(const FalseStream& false_stream, const server::NatsAddress& address)
      : server_(false_stream),
        channel_(address.channel),
        subjects_(address.channel),
        nats_("--publish", address, {}) {
    server_.signFrames();
    const auto welcome = decode(server_.welcome());
    const Welcome& said = std::get<Welcome>(welcome.value());
    state_ = {said.description, said.stream, *said.verifying_key, server_.probe()};
    nats_.subscribe(subjects_.pings,
                    [this](auto bytes, const auto& reply) { onPing(bytes, reply); });
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        send();
        restBetweenTurns();
      }
    });
  }

 private:
  [[nodiscard]] double now_s() const { return toSeconds(clock_.now() - begin_); }
  void onPing(std::span<const std::uint8_t> bytes, const std::string& reply) {
    const std::lock_guard lock(mutex_);
    const auto ping = decodeRelayPing(bytes);
    // The stream begins with the first viewer, as that of a malicious server.
    if (!begun_ && ping.ok() && ping.value().wants_datagrams) {
      begun_ = true;
      begin_ = clock_.now();
    }
    const auto answer = ping.ok() ? server_.answer({ping.value().t0}, now_s()) : std::nullopt;
    if (!answer) return;
    const auto said = decode(*answer);  // a pong that cannot be encoded is not sent
    if (!said.ok()) return;
    const Pong& pong = std::get<Pong>(said.value());
    publish(reply, RelayPong{pong.t0, pong.t1, pong.t2});
  }
  void send() {
    const std::lock_guard lock(mutex_);
    if (clock_.now() - heartbeat_ >= server::OriginElection::kHeartbeat) {
      heartbeat_ = clock_.now();
      publish(subjects_.state, state_);
    }
    if (!begun_) return;
    for (const Bytes& message : server_.messages(now_s())) {
      const auto said = decode(message);
      if (said.ok() && std::holds_alternative<StreamDescription>(said.value())) {
        state_.description = std::get<StreamDescription>(said.value());
        publish(subjects_.state, state_);
        continue;
      }
      sendFrame(message);
    }
    if (server_.byDatagrams()) sendFrame({});
  }
  /// The edge does not open frames, so the number of a message stands for the frame's id.
  void sendFrame(const Bytes& message) {
    RelayFrame frame;
    frame.id = number_ + 1;
    // A false stream by datagrams alone has nothing for TCP: the edge sends the viewers of TCP a
    // repetition.
    static const Bytes kNothing = encode(Preparing{1.0});
    frame.delta = std::make_shared<const Bytes>(message.empty() ? kNothing : message);
    auto bodies = server_.takeDatagrams();
    if (message.empty() && bodies.empty()) return;
    if (!bodies.empty())
      frame.datagrams = std::make_shared<const std::vector<Bytes>>(std::move(bodies));
    publish(subjects_.frames, frame);
  }
  void publish(const std::string& subject, const RelayContent& content) {
    ++number_;
    constexpr std::uint64_t kOrigin = std::uint64_t{9} << 32U;
    const auto whole = encodeRelay(channel_, {1, kOrigin | state_.stream, number_}, content,
                                   [this](auto bytes) { return server_.sign(bytes); });
    for (const auto& piece : splitRelay(whole, number_, nats_.maxPayload()))
      nats_.publish(subject, piece);
  }

  SteadyClock clock_;
  MaliciousServer server_;
  std::mutex mutex_;
  std::string channel_;
  server::Subjects subjects_;
  RelayState state_;
  bool begun_ = false;
  LocalTime begin_ = clock_.now();
  LocalTime heartbeat_{};
  std::uint64_t number_ = 0;
  server::NatsConnection nats_;
  std::jthread thread_;  // last: it uses the others
};

class ProgramsMaliciousOriginTest : public ProgramsMaliciousTest {
 protected:
  void SetUp() override {
    if (!kHasRelays) GTEST_SKIP() << "this build has no libnats";
    if (!NatsServer::exists()) GTEST_SKIP() << "there is no nats-server";
    std::filesystem::create_directories(path("nats"));
    nats_ = std::make_unique<NatsServer>(path("nats"), "");
  }
  void runAll(std::span<const ExpectedMessage> expected) {
    runFalseStreams(expected, [this](const FalseStream& false_stream) {
      const auto address = *server::parseNatsAddress(nats_->channel(false_stream.name));
      edges_.push_back(startServer({"--source", nats_->channel(false_stream.name)}));
      EXPECT_TRUE(edges_.back()->says("waiting for an origin", kStart));
      origins_.push_back(std::make_unique<MaliciousOrigin>(false_stream, address));
      return addressOf(*edges_.back());
    });
    for (const auto& edge : edges_) interrupt(*edge);
  }

 private:
  std::unique_ptr<NatsServer> nats_;
  std::vector<std::unique_ptr<Process>> edges_;
  std::vector<std::unique_ptr<MaliciousOrigin>> origins_;
};

TEST_F(ProgramsMaliciousOriginTest, IsLimitedAndReportedToTheUser) {
  runAll(std::to_array<ExpectedMessage>({
      {"acceleration_1e8_described", "the client does not trust the stream any more"},
      {"acc_square_4hz_x", "no force from now on; restart the client"},
      {"id_max_once", "jumps of the frame ids"},
      {"outside", "not shown"},
      {"silence", "frames arrive: the"},
      {"stiffness_1000", "a wall is softer than the stream asks for"},
      {"structure_cut", "trying again"},
  }));
  // The first line of the client may name another defect of this stream. The summary has all.
  const auto outside = nlohmann::json::parse(std::ifstream(path("outside.json")));
  EXPECT_GT(outside["frames"]["reliefs_refused"], 0);
}

TEST_F(ProgramsMaliciousOriginTest, InDatagramsIsLimitedToo) {
  runAll(std::to_array<ExpectedMessage>({
      {"datagram_ids_max_first", ""},
      {"datagram_copies_contradict_in_turns", ""},
      {"datagram_half_sent", ""},
      {"datagram_probes", ""},
      {"datagram_times_against_tcp", ""},
  }));
}

}  // namespace
}  // namespace hapticast::testing
