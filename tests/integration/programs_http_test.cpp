// SPDX-License-Identifier: MIT
// The server's port for operators (--http), asked through a plain socket.
#include <unistd.h>

#include <array>
#include <nlohmann/json.hpp>

#include "common/build_options.hpp"
#include "common/transport/asio.hpp"
#include "server/page/page_files.hpp"
#include "tests/integration/programs_fixture.hpp"
#include "tests/support/nats_server.hpp"

namespace hapticast::testing {
namespace {

class ProgramsHttpTest : public ProgramsTest {
 protected:
  /// The number of the port that the server's log names.
  static std::uint16_t httpPortOf(Process& server) {
    const std::string line = "figures for operators at http://127.0.0.1:";
    EXPECT_TRUE(server.says(line, kStart)) << server.output();
    const std::string text = server.output();
    return static_cast<std::uint16_t>(std::stoi(text.substr(text.find(line) + line.size())));
  }
  /// The whole response. `fields`: of the request, with the ends of their lines.
  static std::string ask(std::uint16_t port, const std::string& path,
                         const std::string& fields = "") {
    asio::io_context io;
    asio::ip::tcp::socket socket(io);
    socket.connect({asio::ip::address_v4::loopback(), port});
    asio::write(socket, asio::buffer("GET " + path + " HTTP/1.0\r\n" + fields + "\r\n"));
    std::string response;
    boost::system::error_code ec;
    asio::read(socket, asio::dynamic_buffer(response), ec);
    EXPECT_EQ(ec, asio::error::eof);
    return response;
  }
  /// The value of a sample in /metrics; -1 if there is none.
  static double sample(std::uint16_t port, const std::string& name) {
    const std::string text = ask(port, "/metrics");
    const std::size_t at = text.find("\nhapticast_" + name + " ");
    return at == std::string::npos ? -1.0 : std::stod(text.substr(at + 12 + name.size()));
  }
};

TEST_F(ProgramsHttpTest, ThePageIsOnThePortOfTheViewers) {
  const auto portOf = [](const std::string& address) {
    return static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
  };
  const std::string host = "Host: 127.0.0.1\r\n";
  const auto server = startStillServer();
  const std::string address = addressOf(*server);
  const std::string page = ask(portOf(address), "/", host);
  if (server::isPageComplete()) {
    EXPECT_TRUE(server->says("touch it in a browser: http://" + address + "/", kSoon));
    EXPECT_TRUE(page.starts_with("HTTP/1.1 200 OK\r\n")) << page.substr(0, 200);
    EXPECT_NE(page.find("<!doctype html>"), std::string::npos) << page.substr(0, 2000);
  } else {
    EXPECT_TRUE(page.starts_with("HTTP/1.1 503 ")) << page;
    EXPECT_NE(page.find("libc++-dev-wasm32"), std::string::npos) << page;
  }
  EXPECT_TRUE(ask(portOf(address), "/", "Host: evil.example\r\n").starts_with("HTTP/1.1 403 "));
  EXPECT_TRUE(server->says("HTTP 403: This server does not have the name evil.example", kSoon));
  interrupt(*server);
  const auto without = startStillServer({"--page", "off"});
  EXPECT_TRUE(ask(portOf(addressOf(*without)), "/", host)
                  .ends_with("This port is for hapticast-client. It has no pages for a web "
                             "browser.\n"));
  EXPECT_EQ(without->output().find("touch it in a browser"), std::string::npos);
  interrupt(*without);
}

TEST_F(ProgramsHttpTest, FiguresMoveWhenAViewerJoins) {
  const auto server = startServer(
      {"--source", makeClip("clip"), "--loop", "--http", "127.0.0.1:0", "--name", "a \"clip\""});
  const std::string address = addressOf(*server);
  const std::uint16_t port = httpPortOf(*server);
  EXPECT_EQ(sample(port, "viewers"), 0.0);
  const auto client = startClient({address, "--hand", "press", "--view", "off"});
  EXPECT_TRUE(waitUntil(kSoon, [&] { return sample(port, "viewers") == 1.0; }));
  EXPECT_TRUE(waitUntil(
      kSoon, [&] { return sample(port, "sent_bytes_total{transport=\"udp\"}") > 10'000.0; }));
  EXPECT_GT(sample(port, "sent_bytes_total{transport=\"tcp\"}"), 100.0);
  EXPECT_EQ(sample(port, "viewers_by_way{way=\"tcp\"}"), 1.0);
  EXPECT_EQ(sample(port, "viewers_by_way{way=\"websocket\"}"), 0.0);
  EXPECT_GT(sample(port, "frames_published_total"), 1.0);
  for (const char* stage : {"vision", "encode", "sign"}) {
    const std::string name = "stage_duration_seconds_sum{stage=\"" + std::string(stage) + "\"}";
    EXPECT_GT(sample(port, name), 0.0) << stage;
  }
  EXPECT_NE(sample(port, "plan_stage_enabled{object=\"0\",stage=\"clean\"}"), -1.0);
  EXPECT_EQ(sample(port, "stream_info{stream=\"a \\\"clip\\\"\"}"), 1.0);
  const std::string health = ask(port, "/health");
  EXPECT_TRUE(health.starts_with("HTTP/1.1 200 OK\r\n") &&
              health.ends_with("\r\n\r\nok: sends frames\n"))
      << health;
  const std::string response = ask(port, "/status.json");
  const auto status = nlohmann::json::parse(response.substr(response.find("\r\n\r\n")));
  EXPECT_EQ(status.at("stream"), "a \"clip\"");
  EXPECT_EQ(status.at("viewers").at("welcomed"), 1);
  interrupt(*client);
  EXPECT_TRUE(waitUntil(kSoon, [&] { return sample(port, "viewers") == 0.0; }));
  interrupt(*server);
}

TEST_F(ProgramsHttpTest, AServerThatWaitsForAViewerIsHealthyAndOpensNoOtherPort) {
  const auto waiting =
      startServer({"--source", makeClip("clip"), "--loop", "--http", "0", "--wait-for-viewer"});
  EXPECT_TRUE(waiting->says("waiting for the first viewer", kStart)) << waiting->output();
  const std::uint16_t port = httpPortOf(*waiting);
  EXPECT_TRUE(ask(port, "/health").starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_EQ(sample(port, "frames_published_total"), 0.0);
  interrupt(*waiting);
  const auto plain = startServer({"--source", makeClip("clip"), "--loop"});
  addressOf(*plain);
  EXPECT_EQ(countOccurrences("figures for operators", plain->output()), 0U) << plain->output();
  interrupt(*plain);
}

TEST_F(ProgramsHttpTest, OnlyNamesOfTheServerAreAnswered) {
  const auto server = startStillServer({"--http", "127.0.0.1:0", "--host-name", "figures.example"});
  const std::uint16_t port = httpPortOf(*server);
  std::array<char, 256> machine{};
  ASSERT_EQ(::gethostname(machine.data(), machine.size() - 1), 0);
  const std::vector<std::string> names{"127.0.0.1", "localhost", "figures.example", machine.data()};
  for (const std::string& name : names)
    EXPECT_EQ(ask(port, "/metrics", "Host: " + name + "\r\n").substr(9, 3), "200") << name;
  EXPECT_EQ(ask(port, "/metrics", "Host: evil.example\r\n").substr(9, 3), "421");
  interrupt(*server);
}

TEST_F(ProgramsHttpTest, AnEdgeIsHealthyWhileAnOriginSends) {
  if (!kHasRelays) GTEST_SKIP() << "this build has no libnats";
  if (!NatsServer::exists()) GTEST_SKIP() << "there is no nats-server";
  std::filesystem::create_directories(path("nats"));
  const NatsServer nats(path("nats"), "");
  const auto edge = startServer({"--source", nats.channel("lab"), "--http", "127.0.0.1:0"});
  const std::uint16_t port = httpPortOf(*edge);
  EXPECT_TRUE(waitUntil(kSoon, [&] {
    const std::string health = ask(port, "/health");
    return health.starts_with("HTTP/1.1 503 ") && health.ends_with(
                                                      "this edge has no origin: none "
                                                      "sends on its channel\n");
  }));
  EXPECT_EQ(sample(port, "relay_connected{role=\"edge\"}"), 1.0);
  const auto origin = startServer(
      {"--source", "synthetic:bounce", "--loop", "--publish", nats.channel("lab"), "--http", "0"});
  EXPECT_TRUE(waitUntil(kStart, [&] { return ask(port, "/health").starts_with("HTTP/1.1 200 "); }));
  const std::uint16_t origin_port = httpPortOf(*origin);
  EXPECT_EQ(sample(origin_port, "relay_active{role=\"origin\"}"), 1.0);
  EXPECT_EQ(sample(origin_port, "relay_term{role=\"origin\"}"),
            sample(port, "relay_term{role=\"edge\"}"));
  EXPECT_GT(sample(port, "relay_term{role=\"edge\"}"), 1e9) << "the time of the start";
  EXPECT_GT(sample(port, "clock_error_seconds"), 0.0);
  EXPECT_EQ(sample(origin_port, "clock_error_seconds"), 0.0);
  EXPECT_GE(sample(port, "relay_heartbeat_age_seconds{role=\"edge\"}"), 0.0);
  interrupt(*origin);
  EXPECT_TRUE(waitUntil(kSoon, [&] { return ask(port, "/health").starts_with("HTTP/1.1 503 "); }));
  interrupt(*edge);
}

}  // namespace
}  // namespace hapticast::testing
