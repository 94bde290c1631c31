// SPDX-License-Identifier: MIT
// LiveServer with real connections of Beast's client, and of peers that break the rules.
#include "common/live/live_server.hpp"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/cli/run_program.hpp"
#include "common/live/message_outputs.hpp"
#include "common/recording/mcap_reader.hpp"
#include "common/recording/schemas.hpp"
#include "tests/support/temp_folder.hpp"

namespace hapticast {
namespace {

namespace websocket = boost::beast::websocket;
using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kState = 0, kEvents = 1;

/// Ends a test that waits for the network for ever.
void limitTime(asio::ip::tcp::socket& socket) {
  const timeval limit{20, 0};
  ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
}

/// A program that watches.
class Client {
 public:
  explicit Client(const LiveServer& server, const std::string& origin = "") : socket_(io_) {
    socket_.next_layer().connect({asio::ip::make_address("127.0.0.1"), server.address().port});
    limitTime(socket_.next_layer());
    socket_.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
      request.set(boost::beast::http::field::sec_websocket_protocol,
                  "other, foxglove.websocket.v1");
      if (!origin.empty()) request.set(boost::beast::http::field::origin, origin);
    }));
    socket_.read_message_max(64U << 20U);
    boost::system::error_code ec;
    socket_.handshake(response_, "127.0.0.1", "/", ec);
    is_open_ = !ec;
    if (!is_open_) return;
    info_ = Json::parse(readText());
    advertised_ = Json::parse(readText());
  }
  void send(const std::string& text) { socket_.write(asio::buffer(text)); }
  void subscribe(std::uint32_t number, std::size_t channel) {
    send(
        Json{{"op", "subscribe"}, {"subscriptions", {{{"id", number}, {"channelId", channel + 1}}}}}
            .dump());
  }
  std::string readText() {
    boost::beast::flat_buffer buffer;
    socket_.read(buffer);
    is_text_ = socket_.got_text();
    return boost::beast::buffers_to_string(buffer.data());
  }
  /// Returns the next data of a subscription.
  std::string readData(std::uint32_t number) {
    const std::string message = readText();
    EXPECT_FALSE(is_text_) << message;
    EXPECT_EQ(message.substr(0, 5), std::string({1, char(number), 0, 0, 0}));
    return message.substr(13);
  }
  [[nodiscard]] bool isOpen() const { return is_open_; }
  [[nodiscard]] const Json& advertised() const { return advertised_; }
  [[nodiscard]] const Json& info() const { return info_; }
  websocket::stream<asio::ip::tcp::socket>& socket() { return socket_; }
  [[nodiscard]] bool isText() const { return is_text_; }
  [[nodiscard]] std::string protocol() const {
    return std::string(response_[boost::beast::http::field::sec_websocket_protocol]);
  }

 private:
  asio::io_context io_;
  websocket::stream<asio::ip::tcp::socket> socket_;
  websocket::response_type response_;
  Json info_, advertised_;
  bool is_open_ = false, is_text_ = false;
};

class LiveServerTest : public ::testing::Test {
 protected:
  void waitUntilWanted(std::size_t channel) const {
    while (!server_.isWanted(channel)) std::this_thread::yield();
  }
  static Bytes toBytes(const std::string& text) { return {text.begin(), text.end()}; }

  LiveServer server_{{"127.0.0.1", 0},
                     "program",
                     {makeChannel("/state", "hapticast.proto.Plan", true),
                      makeChannel("/events", "foxglove.Log")}};
};

TEST_F(LiveServerTest, AdvertisesChannelsWithTheirSchemas) {
  const Client client(server_);
  ASSERT_TRUE(client.isOpen());
  EXPECT_EQ(client.protocol(), kLiveProtocol);
  EXPECT_EQ(client.info()["name"], "program");
  EXPECT_EQ(client.info()["capabilities"], Json::array());
  const Json& channels = client.advertised()["channels"];
  ASSERT_EQ(channels.size(), 2U);
  EXPECT_EQ(channels[0]["topic"], "/state");
  EXPECT_EQ(channels[1]["id"], 2);
  EXPECT_EQ(channels[1]["schemaName"], "foxglove.Log");
  EXPECT_GT(channels[1]["schema"].get<std::string>().size(), 100U);
}

TEST_F(LiveServerTest, SendsMessagesOfASubscriptionOnly) {
  Client client(server_);
  EXPECT_FALSE(server_.isWanted(kEvents));
  server_.push(kEvents, 1, toBytes("before"));
  client.subscribe(7, kEvents);
  waitUntilWanted(kEvents);
  server_.push(kEvents, 0x0102030405060708, toBytes("event"));
  const std::string message = client.readText();
  EXPECT_EQ(message, std::string("\x01\x07\0\0\0\x08\x07\x06\x05\x04\x03\x02\x01"
                                 "event",
                                 18));
  client.send(R"({"op":"unsubscribe","subscriptionIds":[7, 8]})");
  while (server_.isWanted(kEvents)) std::this_thread::yield();
}

TEST_F(LiveServerTest, SendsTheNewestMessageOfAStateToALateWatcher) {
  server_.push(kState, 1, toBytes("old"));
  server_.push(kState, 2, toBytes("new"));
  Client client(server_);
  client.subscribe(1, kState);
  EXPECT_EQ(client.readData(1), "new");
}

TEST_F(LiveServerTest, WarnsOfOtherRequests) {
  Client client(server_);
  for (const char* const text :
       {"", "{", "[]", R"({"op":"setParameters"})", R"({"op":"subscribe"})",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":3}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":0}]})",
        R"({"op":"unsubscribe","subscriptionIds":["1"]})"}) {
    client.send(text);
    const std::string answer = client.readText();
    EXPECT_NE(answer.find("\"status\""), std::string::npos) << text << ": " << answer;
  }
  EXPECT_FALSE(server_.isWanted(kEvents));
}

TEST_F(LiveServerTest, LimitsSubscriptions) {
  Client client(server_);
  for (std::uint32_t i = 0; i <= Watcher::kMostSubscriptions; ++i) client.subscribe(i, kEvents);
  EXPECT_NE(client.readText().find("one too many"), std::string::npos);
}

TEST_F(LiveServerTest, ASlowWatcherLosesMessagesAndGetsTheirNumber) {
  Client slow(server_), fast(server_);
  slow.subscribe(1, kEvents);
  fast.subscribe(1, kEvents);
  waitUntilWanted(kEvents);
  slow.subscribe(2, kState);  // so the subscription before it is there
  server_.push(kState, 1, toBytes("state"));
  EXPECT_EQ(slow.readData(2), "state");
  fast.subscribe(2, kState);
  EXPECT_EQ(fast.readData(2), "state");
  const Bytes large(1U << 20U, 1);
  constexpr int kMessages = 40;  // more than queue and socket hold
  for (int i = 0; i < kMessages; ++i) {
    server_.push(kEvents, 1, large);
    EXPECT_EQ(fast.readData(1).size(), large.size());
  }
  int received = 0, lost = 0;
  while (received + lost < kMessages) {
    const std::string text = slow.readText();
    if (slow.isText()) {
      lost += std::stoi(Json::parse(text)["message"].get<std::string>());
    } else {
      ++received;
    }
  }
  EXPECT_LT(received, kMessages);
}

TEST_F(LiveServerTest, OtherSitesMayNotWatch) {
  EXPECT_TRUE(Client(server_, "http://localhost:8080").isOpen());
  EXPECT_FALSE(Client(server_, "https://evil.example").isOpen());
  EXPECT_TRUE(isTrustedPage("", "anything"));
  EXPECT_TRUE(isTrustedPage("http://192.0.2.1:8080", "192.0.2.1:8765"));
  EXPECT_TRUE(isTrustedPage("http://[2001:db8::1]", "[2001:db8::1]:8765"));
  EXPECT_FALSE(isTrustedPage("http://192.0.2.2", "192.0.2.1:8765"));
  EXPECT_FALSE(isTrustedPage("http://evil.example", "evil.example"));  // DNS rebinding
  EXPECT_FALSE(isTrustedPage("http://localhost.evil.example", "127.0.0.1"));
  EXPECT_FALSE(isTrustedPage("null", "127.0.0.1"));
}

/// Returns whether the server closes the connection after `bytes`. It reads all until then.
bool closesAfter(Client& client, const std::string& bytes) {
  auto& socket = client.socket().next_layer();
  boost::system::error_code ec;
  asio::write(socket, asio::buffer(bytes), ec);
  std::vector<char> rest(1U << 16U);
  while (!ec) socket.read_some(asio::buffer(rest), ec);
  return ec == asio::error::eof || ec == asio::error::connection_reset;
}

TEST_F(LiveServerTest, ClosesConnectionsThatBreakTheProtocol) {
  const std::string mask(4, '\0');
  for (const std::string& frame :
       {"\x81\xFF\x80" + std::string(7, '\0') + mask,  // a length of 2^63
        "\x81\xFF" + std::string(8, '\xFF') + mask,    // of 2^64 - 1
        std::string("\x81\x01x"),                      // no mask
        "\x83\x80" + mask,                             // an unknown opcode
        std::string("\x89\xFE\x04\x00", 4) + mask}) {  // a ping of 1,024 bytes
    Client client(server_);
    client.subscribe(1, kEvents);
    EXPECT_TRUE(closesAfter(client, frame));
  }
  while (server_.isWanted(kEvents)) std::this_thread::yield();
}

TEST_F(LiveServerTest, AFloodOfPingsDelaysNoOtherWatcher) {
  Client flood(server_), other(server_);
  flood.socket().next_layer().non_blocking(true);
  std::string pings;
  for (int i = 0; i < 10000; ++i) pings += std::string("\x89\x80\0\0\0\0", 6);
  boost::system::error_code ec;
  for (int i = 0; i < 100 && !ec; ++i)
    flood.socket().next_layer().write_some(asio::buffer(pings), ec);
  other.subscribe(1, kEvents);
  waitUntilWanted(kEvents);
  server_.push(kEvents, 1, toBytes("event"));
  EXPECT_EQ(other.readData(1), "event");
}

TEST_F(LiveServerTest, ClosesOneConnectionTooMany) {
  std::vector<std::unique_ptr<Client>> clients;
  for (std::size_t i = 0; i < LiveServer::kMostWatchers; ++i) {
    clients.push_back(std::make_unique<Client>(server_));
    EXPECT_TRUE(clients.back()->isOpen());
  }
  EXPECT_FALSE(Client(server_).isOpen());
  clients.pop_back();
  while (!Client(server_).isOpen()) std::this_thread::yield();
}

TEST_F(LiveServerTest, ConnectionsThatSayNothingTakeNoPlaceOfAWatcher) {
  asio::io_context io;
  std::vector<asio::ip::tcp::socket> silent;
  for (std::size_t i = 0; i < 3 * LiveServer::kMostSilent; ++i) {
    silent.emplace_back(io).connect(
        {asio::ip::make_address(server_.address().host), server_.address().port});
    if (i % LiveServer::kMostSilent != 0) continue;
    EXPECT_TRUE(Client(server_).isOpen()) << i;
  }
  EXPECT_TRUE(Client(server_).isOpen());
}

TEST(MessageOutputs, RecordingAndWatchersHaveTheLinesOfTheLog) {
  const TempFolder folder;
  const std::string file = (folder / "run.mcap").string();
  const auto before = spdlog::default_logger();
  startLog("outputs");
  {
    MessageOutputs outputs({file, Endpoint{"127.0.0.1", 0}}, "program", "no people",
                           {makeChannel("/state", "hapticast.proto.Plan", true)},
                           [] { return std::uint64_t{1'500'000'000}; });
    EXPECT_TRUE(outputs.isWanted(0));
    spdlog::warn("a line of the log");
    spdlog::debug("not in the log");
  }
  spdlog::warn("after the run");
  spdlog::set_default_logger(before);
  auto reader = McapReader::open(file);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  std::vector<std::string> lines;
  while (const auto message = reader.value().next()) {
    if (reader.value().channels().at(message->channel).topic != "/log") continue;
    EXPECT_EQ(message->time_ns, 1'500'000'000U);
    lines.emplace_back(message->data.begin(), message->data.end());
  }
  ASSERT_EQ(lines.size(), 1U);
  // Timestamp of 1.5 s, level 3 (warning), text, program.
  EXPECT_EQ(lines[0], std::string("\x0A\x08\x08\x01\x10\x80\xCA\xB5\xEE\x01\x10\x03\x1A\x11", 14) +
                          "a line of the log\x22\x07program");
}

TEST(MessageOutputs, WithoutWatchersOrARecordingNothingIsWanted) {
  MessageOutputs outputs({"", Endpoint{"127.0.0.1", 0}}, "program", "no people",
                         {makeChannel("/events", "foxglove.Log")}, [] { return std::uint64_t{0}; });
  EXPECT_FALSE(outputs.isWanted(0));
}

}  // namespace
}  // namespace hapticast
