// SPDX-License-Identifier: MIT
// Origins, edges and clients as programs, with a real nats-server between them: what passes, what
// fails how, and what wrong messages cause.
#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/build_options.hpp"
#include "common/protocol/relay.hpp"
#include "server/relay/nats_connection.hpp"
#include "server/relay/subjects.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/support/nats_server.hpp"
#include "tests/support/relay_messages.hpp"

namespace hapticast::testing {
namespace {

class ProgramsRelayTest : public ProgramsTest {
 protected:
  void SetUp() override {
    if (!kHasRelays) GTEST_SKIP() << "this build has no libnats";
    if (!NatsServer::exists()) GTEST_SKIP() << "there is no nats-server";
    keepPorts();
    std::filesystem::create_directories(path("nats"));
    nats_ = std::make_unique<NatsServer>(path("nats"), settings());
  }
  [[nodiscard]] virtual std::string settings() const { return ""; }

  [[nodiscard]] std::unique_ptr<Process> startOrigin(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--source", "synthetic:bounce", "--loop", "--map-range", "520,620",
                               "--motion", "none", "--publish", nats_->channel("lab")});
    return startServer(std::move(more));
  }
  [[nodiscard]] std::unique_ptr<Process> startEdge(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--source", nats_->channel("lab")});
    return startServer(std::move(more));
  }
  [[nodiscard]] std::unique_ptr<Process> startViewer(const std::string& address,
                                                     const std::string& name,
                                                     std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {address, "--device", "virtual", "--hand", "press", "--log",
                               path(name + ".csv"), "--summary", path(name + ".json")});
    return startClient(std::move(more));
  }
  /// Ends a client; its force never stepped beyond what the chain allows.
  [[nodiscard]] nlohmann::json endViewer(Process& client, const std::string& name) const {
    interrupt(client);
    auto summary = nlohmann::json::parse(std::ifstream(path(name + ".json")));
    EXPECT_EQ(summary["step_excess_max_N"], 0.0) << client.output();
    EXPECT_EQ(summary["frames"]["malformed"], 0) << client.output();
    return summary;
  }
  /// How many ticks lay between two received frames so far.
  [[nodiscard]] std::size_t countInterpolated(const std::string& name) const {
    const auto rows = readLog(path(name + ".csv"));
    return static_cast<std::size_t>(std::count_if(
        rows.begin(), rows.end(), [](const LogRow& row) { return row.lookup == "interpolated"; }));
  }
  /// Whether frames arrive from now on.
  [[nodiscard]] bool framesArrive(const std::string& name) const {
    const std::size_t before = countInterpolated(name);
    return waitUntil(kSoon, [&] { return countInterpolated(name) > before + 500; });
  }

  std::unique_ptr<NatsServer> nats_;
};

TEST_F(ProgramsRelayTest, AnEdgeServesTheOriginsStreamByEachTransport) {
  const auto origin = startOrigin();
  const auto edge = startEdge();
  const std::string address = addressOf(*edge);
  const auto udp = startViewer(address, "udp");
  const auto tcp = startViewer(address, "tcp", {"--transport", "tcp"});
  EXPECT_TRUE(framesArrive("udp") && framesArrive("tcp"));
  ASSERT_TRUE(waitUntil(kSoon, [&] { return countInterpolated("tcp") > 3000; }));
  const auto by_udp = endViewer(*udp, "udp"), by_tcp = endViewer(*tcp, "tcp");
  EXPECT_EQ(by_udp["delivery"]["way"], "udp");
  EXPECT_GT(by_udp["max_force_N"], 0.3);
  EXPECT_EQ(by_tcp["frames"]["reliefs_refused"], 0);
  // The edge's part of the error is in the figure: it is more than a viewer's own on loopback.
  EXPECT_GT(by_tcp["clock_error_us"], 0.0);
  interrupt(*edge);
  interrupt(*origin);
}

TEST_F(ProgramsRelayTest, ARecordingFeedsEdgesAndARecorder) {
  const auto recorded = startServer({"--source", "synthetic:bounce", "--map-range", "520,620",
                                     "--frames", "60", "--record", path("first.mcap")});
  ASSERT_EQ(recorded->wait(kStart), 0) << recorded->output();
  const auto origin = startServer({"--source", path("first.mcap"), "--loop", "--publish",
                                   nats_->channel("lab"), "--record", path("second.mcap")});
  const auto edge = startEdge();
  const auto viewer = startViewer(addressOf(*edge), "edge");
  ASSERT_TRUE(waitUntil(kSoon, [&] { return countInterpolated("edge") > 3000; }));
  EXPECT_EQ(endViewer(*viewer, "edge")["frames"]["reliefs_refused"], 0);
  interrupt(*edge);
  interrupt(*origin);
  const auto again = startServer({"--source", path("second.mcap"), "--frames", "60"});
  EXPECT_EQ(again->wait(kStart), 0) << again->output();
}

TEST_F(ProgramsRelayTest, AStandbyTakesOverAndTheViewersStayConnected) {
  const auto first = startOrigin();
  ASSERT_TRUE(first->says("active (term", kStart)) << first->output();
  const auto second = startOrigin();
  const auto edge = startEdge();
  const std::string address = addressOf(*edge);
  const auto udp = startViewer(address, "udp");
  const auto tcp = startViewer(address, "tcp", {"--transport", "tcp"});
  EXPECT_TRUE(framesArrive("udp") && framesArrive("tcp"));
  EXPECT_EQ(countOccurrences("active (term", second->output()), 0U);
  first->signal(SIGKILL);
  EXPECT_TRUE(second->says("active (term", kSoon)) << second->output();
  EXPECT_TRUE(edge->says("another origin sends from now on", kSoon)) << edge->output();
  EXPECT_TRUE(framesArrive("udp") && framesArrive("tcp"));
  for (Process* client : {udp.get(), tcp.get()}) {
    EXPECT_EQ(countOccurrences("trying again", client->output()), 0U) << client->output();
    EXPECT_EQ(countOccurrences("another server makes the stream", client->output()), 1U)
        << client->output();
  }
  (void)endViewer(*udp, "udp");
  (void)endViewer(*tcp, "tcp");
  interrupt(*edge);
  interrupt(*second);
}

/// Publishes every hostile message on every subject of the channel, and in pings.
void publishHostileMessages(const server::NatsAddress& address) {
  server::NatsConnection nats("--publish", address, {});
  const server::Subjects subjects(address.channel);
  SigningKey rival;
  const auto now_s = static_cast<std::uint64_t>(std::time(nullptr));
  std::uint64_t number = 0;
  for (const std::uint64_t extreme : server::listExtremes(now_s)) {
    for (const auto& whole : server::listHostileMessages(rival, now_s, extreme)) {
      for (const auto& piece : splitRelay(whole, ++number, nats.maxPayload())) {
        nats.publish(subjects.state, piece);
        nats.publish(subjects.frames, piece);
      }
      const RelayPing ping{LocalTime(Duration(static_cast<std::int64_t>(extreme))), true, true,
                           whole};
      for (const std::string& reply : {server::NatsConnection::makeInbox(), subjects.state})
        nats.publish(subjects.pings, encodeRelayPing(ping), reply);
    }
  }
}

// HAPTICAST_TAKEOVERS sets the number of takeovers, 2 by default.
TEST_F(ProgramsRelayTest, AfterEveryHostileMessageAStandbyTakesOver) {
  const char* const asked = std::getenv("HAPTICAST_TAKEOVERS");
  const int takeovers = asked != nullptr ? std::atoi(asked) : 2;
  const std::vector<std::string> with_key{"--signing-key", path("key")};
  auto active = startOrigin(with_key);
  ASSERT_TRUE(active->says("active (term", kStart)) << active->output();
  const std::string output = active->output();
  const std::string key = output.substr(output.find("origin key: ") + 12, 64);
  const auto strict = startEdge({"--origin-key", key}), open = startEdge();
  const auto strict_viewer = startViewer(addressOf(*strict), "strict", {"--transport", "tcp"});
  const auto open_viewer = startViewer(addressOf(*open), "open", {"--transport", "tcp"});
  EXPECT_TRUE(framesArrive("strict") && framesArrive("open"));
  for (int i = 0; i < takeovers; ++i) {
    auto standby = startOrigin(with_key);
    ASSERT_TRUE(standby->says("listening on", kStart)) << standby->output();
    publishHostileMessages(*server::parseNatsAddress(nats_->channel("lab")));
    EXPECT_TRUE(framesArrive("strict")) << "the origin before";
    active->signal(SIGKILL);
    EXPECT_TRUE(standby->says("active (term", kSoon)) << i << standby->output();
    EXPECT_TRUE(framesArrive("strict") && framesArrive("open")) << i;
    active = std::move(standby);
  }
  EXPECT_EQ(countOccurrences("another origin sends from now on", strict->output()),
            static_cast<std::size_t>(takeovers))
      << "one second Welcome for each takeover";
  (void)endViewer(*strict_viewer, "strict");
  (void)endViewer(*open_viewer, "open");
  interrupt(*strict);
  interrupt(*open);
  interrupt(*active);
}

/// Records every message of a channel, and publishes each of them again, all the time.
class Replayer {
 public:
  explicit Replayer(const server::NatsAddress& address) : nats_("--publish", address, {}) {
    const server::Subjects subjects(address.channel);
    for (const std::string& subject : {subjects.state, subjects.frames, subjects.pings})
      nats_.subscribe(subject, [this, subject](auto bytes, const std::string& reply) {
        const std::lock_guard lock(mutex_);
        if (recorded_.size() < kMost)
          recorded_.push_back({subject, {bytes.begin(), bytes.end()}, reply});
      });
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

 private:
  static constexpr std::size_t kMost = 2000;
  struct Recorded {
    std::string subject;
    std::vector<std::uint8_t> bytes;
    std::string reply;
  };
  void run(const std::stop_token& stop) {
    std::condition_variable_any pause;
    for (std::size_t next = 0; !stop.stop_requested(); ++next) {
      std::unique_lock lock(mutex_);
      // About 3,000 a second: the pause has no part in the result.
      pause.wait_for(lock, stop, std::chrono::microseconds(300), [] { return false; });
      if (recorded_.empty()) continue;
      const Recorded again = recorded_[next % recorded_.size()];
      lock.unlock();
      nats_.publish(again.subject, again.bytes, again.reply);
      ++sent_;
    }
  }

  std::mutex mutex_;
  std::vector<Recorded> recorded_;  // guarded by mutex_
  std::atomic<std::uint64_t> sent_{0};
  server::NatsConnection nats_;
  std::jthread thread_;  // last: it uses the others
};

// A recording of the channel cannot keep a dead origin alive, nor stop the living one.
TEST_F(ProgramsRelayTest, BesideEachMessageAgainAStandbyTakesOver) {
  const std::vector<std::string> with_key{"--signing-key", path("key")};
  auto active = startOrigin(with_key);
  ASSERT_TRUE(active->says("active (term", kStart)) << active->output();
  const auto edge = startEdge();
  const auto viewer = startViewer(addressOf(*edge), "edge", {"--transport", "tcp"});
  EXPECT_TRUE(framesArrive("edge"));
  const Replayer replayer(*server::parseNatsAddress(nats_->channel("lab")));
  for (int i = 0; i < 2; ++i) {
    auto standby = startOrigin(with_key);
    ASSERT_TRUE(standby->says("standby, because another origin is active", kStart))
        << standby->output();
    EXPECT_TRUE(framesArrive("edge")) << "the origin before";
    active->signal(SIGKILL);
    EXPECT_TRUE(standby->says("active (term", kSoon)) << i << standby->output();
    EXPECT_TRUE(framesArrive("edge")) << i;
    active = std::move(standby);
  }
  EXPECT_GT(replayer.sent(), 1000U);
  EXPECT_EQ(countOccurrences("another origin sends from now on", edge->output()), 2U)
      << edge->output();
  (void)endViewer(*viewer, "edge");
  interrupt(*edge);
  interrupt(*active);
}

TEST_F(ProgramsRelayTest, AnEdgeWithoutOriginKeepsItsViewersUntilOneSends) {
  auto origin = startOrigin();
  const auto edge = startEdge();
  const auto client = startViewer(addressOf(*edge), "wait");
  EXPECT_TRUE(framesArrive("wait"));
  origin->signal(SIGKILL);
  EXPECT_TRUE(edge->says("no origin sends; viewers stay connected and wait", kSoon))
      << edge->output();
  EXPECT_TRUE(client->says("no new frames arrive: the force has faded", kSoon)) << client->output();
  origin = startOrigin();
  EXPECT_TRUE(edge->says("an origin sends again", kSoon)) << edge->output();
  EXPECT_TRUE(framesArrive("wait"));
  EXPECT_EQ(countOccurrences("trying again", client->output()), 0U) << client->output();
  (void)endViewer(*client, "wait");
  interrupt(*edge);
  interrupt(*origin);
}

TEST_F(ProgramsRelayTest, ANatsServerMayRestart) {
  const auto origin = startOrigin();
  const auto edge = startEdge();
  const auto client = startViewer(addressOf(*edge), "restart");
  EXPECT_TRUE(framesArrive("restart"));
  nats_->kill();
  EXPECT_TRUE(origin->says("the connection to NATS is lost", kSoon)) << origin->output();
  EXPECT_TRUE(edge->says("the connection to NATS is lost", kSoon)) << edge->output();
  nats_->restart(settings());
  EXPECT_TRUE(edge->says("connected to NATS again", kSoon)) << edge->output();
  EXPECT_TRUE(framesArrive("restart"));
  (void)endViewer(*client, "restart");
  interrupt(*edge);
  interrupt(*origin);
}

class ProgramsRelayUserTest : public ProgramsRelayTest {
 protected:
  [[nodiscard]] std::string settings() const override {
    return "authorization { users: [ { user: me, password: \"p@ss/word\" } ] }\n";
  }
};

TEST_F(ProgramsRelayUserTest, AUserOfNatsIsAcceptedAndNeverLogged) {
  const std::string channel = "nats://me:p%40ss%2Fword@" + nats_->host() + "/lab";
  const auto origin = startServer({"--source", "synthetic:bounce", "--loop", "--publish", channel});
  const auto edge = startServer({"--source", channel});
  const auto client = startViewer(addressOf(*edge), "user");
  EXPECT_TRUE(framesArrive("user"));
  interrupt(*client);
  const auto stranger = startServer({"--source", "nats://me:s3cr3t@" + nats_->host() + "/lab"});
  EXPECT_EQ(stranger->wait(kSoon), 1);
  EXPECT_NE(stranger->output().find("NATS refuses the credentials"), std::string::npos)
      << stranger->output();
  interrupt(*edge);
  interrupt(*origin);
  for (const Process* each : {origin.get(), edge.get(), client.get(), stranger.get()}) {
    for (const char* secret : {"p%40ss", "p@ss", "s3cr3t"})
      EXPECT_EQ(each->output().find(secret), std::string::npos) << each->output();
  }
}

TEST_F(ProgramsRelayTest, IgnoresMessagesOfUnauthorisedSenders) {
  const auto origin = startOrigin();
  const auto edge = startEdge();
  const auto client = startViewer(addressOf(*edge), "stranger");
  EXPECT_TRUE(framesArrive("stranger"));
  const server::Subjects subjects("lab");
  server::NatsConnection unauthorised("--publish", *server::parseNatsAddress(nats_->channel("lab")),
                                      {});
  const std::vector<std::uint8_t> noise(700'000, std::uint8_t{0x5a});
  for (int i = 0; i < 40; ++i) {
    for (const std::string& subject : {subjects.state, subjects.frames, subjects.pings}) {
      (void)unauthorised.publish(subject, noise);
      (void)unauthorised.publish(subject, {});
    }
  }
  const auto forged = encodeRelay("lab", {std::uint64_t{1} << 61U, 5, 1}, RelayPong{},
                                  [](auto /*bytes*/) { return Signature{}; });
  (void)unauthorised.publish(subjects.state, splitRelay(forged, 1, 100'000).front());
  EXPECT_TRUE(origin->says("it ignores heartbeats: a term is more than a day ahead", kSoon))
      << origin->output();
  EXPECT_TRUE(edge->says("bytes that are not a piece of a relayed message", kSoon))
      << edge->output();
  EXPECT_TRUE(framesArrive("stranger"));
  EXPECT_LE(countOccurrences("a message was dropped", edge->output()), 8U) << "the log is limited";
  EXPECT_EQ(countOccurrences("standby", origin->output()), 0U) << origin->output();
  EXPECT_EQ(endViewer(*client, "stranger")["frames"]["resyncs"], 0);
  interrupt(*edge);
  interrupt(*origin);
}

class ProgramsSmallPayloadTest : public ProgramsRelayTest {
 protected:
  [[nodiscard]] std::string settings() const override { return "max_payload: 1500\n"; }
};

TEST_F(ProgramsSmallPayloadTest, LargeFramesTravelInPieces) {
  const auto origin = startOrigin();
  const auto edge = startEdge();
  const auto client = startViewer(addressOf(*edge), "pieces");
  EXPECT_TRUE(framesArrive("pieces"));
  const auto summary = endViewer(*client, "pieces");
  EXPECT_EQ(summary["frames"]["lost"], 0);
  interrupt(*edge);
  interrupt(*origin);
}

class ProgramsRelayAccessTest : public ProgramsRelayTest {
 protected:
  [[nodiscard]] std::string settings() const override {
    return "authorization { user: lab, password: secret }\n";
  }
};

TEST_F(ProgramsRelayAccessTest, RefusedCredentialsAreOneLine) {
  const auto origin = startOrigin();
  EXPECT_EQ(origin->wait(kStart), 1) << origin->output();
  EXPECT_TRUE(origin->output().ends_with(
      "--publish " + nats_->channel("lab") +
      ": NATS refuses the credentials; see --nats-creds, or use " + server::kNatsForm + "\n"))
      << origin->output();
  const auto edge = startEdge();
  EXPECT_EQ(edge->wait(kStart), 1) << edge->output();
  EXPECT_TRUE(edge->output().ends_with("--source " + nats_->channel("lab") +
                                       ": NATS refuses the credentials; see --nats-creds, or use " +
                                       server::kNatsForm + "\n"))
      << edge->output();
}

}  // namespace
}  // namespace hapticast::testing
