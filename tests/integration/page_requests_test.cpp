// SPDX-License-Identifier: MIT
// The page over loopback: many phones, slow lines, and clients that do not read.
#include <gmock/gmock.h>

#include <random>

#include "tests/integration/stream_fixture.hpp"
#include "tests/support/log_lines.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::testing {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A browser that sends one request, and reads when the test says so.
class Browser {
 public:
  Browser(asio::io_context& io, std::uint16_t port, const std::string& path,
          int receive_buffer_bytes = 4096)
      : socket_(io) {
    socket_.open(asio::ip::tcp::v4());
    socket_.set_option(asio::socket_base::receive_buffer_size(receive_buffer_bytes));
    socket_.connect({asio::ip::address_v4::loopback(), port});
    socket_.non_blocking(true);
    const std::string request =
        "GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept-Encoding: gzip\r\n\r\n";
    asio::write(socket_, asio::buffer(request));
  }
  /// Reads at most `bytes` of what has arrived.
  void read(std::size_t bytes = 1U << 20U) {
    std::string chunk(bytes, '\0');
    boost::system::error_code ec;
    const std::size_t size = socket_.read_some(asio::buffer(chunk), ec);
    text.append(chunk, 0, size);
    if (ec && ec != asio::error::would_block) closed = true;
    reset = closed && ec != asio::error::eof;
  }
  [[nodiscard]] std::size_t bodyBytes() const {
    const std::size_t end = text.find("\r\n\r\n");
    return end == std::string::npos ? 0 : text.size() - end - 4;
  }

  std::string text;
  bool closed = false;
  bool reset = false;

 private:
  asio::ip::tcp::socket socket_;
};

class PageRequestsTest : public StreamTest {
 protected:
  static constexpr std::size_t kLarge_bytes = 400'000, kSmall_bytes = 20'000;

  static Bytes noise(std::size_t bytes) {
    std::mt19937 random(1);
    Bytes out(bytes);
    for (std::uint8_t& each : out) each = static_cast<std::uint8_t>(random());
    return out;
  }
  static server::StreamSettings smallBuffers() {
    server::StreamSettings settings;
    settings.send_buffer_bytes = 20'000;
    return settings;
  }
  bool ends(Browser& browser, std::size_t chunk = 1U << 20U) {
    return runUntil([&] {
      browser.read(chunk);
      return browser.closed;
    });
  }
  /// Reads about `bytes` more of the answer, as far as it comes.
  void readMore(Browser& browser, std::size_t bytes) {
    const std::size_t until = browser.text.size() + bytes;
    (void)runUntil([&] {
      browser.read(4096);
      return browser.closed || browser.text.size() >= until;
    });
  }

  // The compressed bytes of a page: their content does not matter here.
  const Bytes large_ = noise(kLarge_bytes), small_ = noise(kSmall_bytes);
  const std::vector<server::PageFile> files_{{"index.html", "text/html", small_, "\"1\""},
                                             {"core.wasm", "application/wasm", large_, "\"2\""}};
};

TEST_F(PageRequestsTest, AHallOfPhonesBehindOneAddressIsServed) {
  constexpr std::size_t kRequests = std::size_t{300} * 8;
  if (server::raiseFileLimit(2 * kRequests) < 2 * kRequests) GTEST_SKIP() << "too few open files";
  const LogLines log;
  server::StreamSettings settings;
  settings.max_pending = server::Broadcaster::kMaxPendingHandshakes;  // as with the page
  TestServer server(io, clock, settings, 0, "127.0.0.1", std::nullopt, files_);
  const auto native = viewer(server);
  std::vector<std::unique_ptr<Browser>> phones;
  for (std::size_t i = 0; i < kRequests; ++i) {
    phones.push_back(std::make_unique<Browser>(io, server.port(), "/"));
    if (i % 300 == 299) turn();
  }
  server.publish(1);
  EXPECT_TRUE(receives<CodedFrame>(*native));
  ASSERT_TRUE(runUntil([&] {
    return std::count_if(phones.begin(), phones.end(), [](const auto& each) {
             if (!each->closed) each->read(8192);
             return each->closed;
           }) == kRequests;
  }));
  for (const auto& each : phones) {
    ASSERT_EQ(each->bodyBytes(), kSmall_bytes);
    ASSERT_FALSE(each->reset);
  }
  EXPECT_EQ(log.text().find("closing"), std::string::npos) << log.text();
  EXPECT_EQ(log.text().find("index.html"), std::string::npos) << "no line for each file";
  EXPECT_EQ(server.broadcaster.counts().refused, 0U);
  EXPECT_TRUE(runUntil([&] { return server.broadcaster.connections() == 1; }));
}

TEST_F(PageRequestsTest, AnAnswerOverASlowLineIsNotCut) {
  ManualClock manual;
  TestServer server(io, manual, smallBuffers(), 0, "127.0.0.1", std::nullopt, files_);
  Browser browser(io, server.port(), "/core.wasm");
  for (int i = 0; i < 10 && !browser.closed; ++i) {  // 40 s, far more than the deadline of a hello
    readMore(browser, kLarge_bytes / 10);
    manual.advance(std::chrono::seconds(4));
    for (int turns = 0; turns < 50; ++turns) turn();
  }
  ASSERT_TRUE(ends(browser));
  EXPECT_EQ(browser.bodyBytes(), kLarge_bytes);
  EXPECT_FALSE(browser.reset);
}

TEST_F(PageRequestsTest, AnAnswerThatNobodyReadsIsCut) {
  ManualClock manual;
  TestServer server(io, manual, smallBuffers(), 0, "127.0.0.1", std::nullopt, files_);
  Browser browser(io, server.port(), "/core.wasm");
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().bytes > 0; }));
  // A late check of the session still finds bytes that filled the buffers: then the next timeout
  // cuts the answer. All of them last less than an answer may.
  const server::StreamSettings settings;
  const auto most = settings.answer_deadline / settings.write_timeout;
  for (int i = 0; i + 1 < most && server.broadcaster.connections() > 0; ++i) {
    for (int turns = 0; turns < 200; ++turns) turn();
    manual.advance(settings.write_timeout);
  }
  EXPECT_TRUE(runUntil([&] { return server.broadcaster.connections() == 0; }));
  ASSERT_TRUE(ends(browser));
  EXPECT_LT(browser.bodyBytes(), kLarge_bytes);
}

TEST_F(PageRequestsTest, AnAnswerEndsAfterAMinute) {
  ManualClock manual;
  TestServer server(io, manual, smallBuffers(), 0, "127.0.0.1", std::nullopt, files_);
  Browser browser(io, server.port(), "/core.wasm");
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().bytes > 0; }));
  for (int second = 0; second < 64 && server.broadcaster.connections() > 0; second += 4) {
    readMore(browser, 12'000);
    for (int turns = 0; turns < 200; ++turns) turn();
    manual.advance(std::chrono::seconds(4));
  }
  EXPECT_TRUE(runUntil([&] { return server.broadcaster.connections() == 0; }));
  ASSERT_TRUE(ends(browser));
  EXPECT_LT(browser.bodyBytes(), kLarge_bytes);
  EXPECT_GT(browser.bodyBytes(), 100'000U);
}

TEST_F(PageRequestsTest, NamesOutsideOfThePageGet404) {
  const LogLines log;
  TestServer server(io, clock, {}, 0, "127.0.0.1", std::nullopt, files_);
  Browser browser(io, server.port(), "/../../etc/passwd");
  ASSERT_TRUE(ends(browser));
  EXPECT_THAT(browser.text, StartsWith("HTTP/1.1 404 Not Found\r\n"));
  EXPECT_THAT(log.text(), HasSubstr("HTTP 404: there is no file /../../etc/passwd"));
}

TEST_F(PageRequestsTest, OneTooManyEndsTheOldestOfItsNetwork) {
  server::StreamSettings settings = smallBuffers();
  settings.max_answers = 3;
  TestServer server(io, clock, settings, 0, "127.0.0.1", std::nullopt, files_);
  std::vector<std::unique_ptr<Browser>> stalled;
  for (int i = 0; i < 4; ++i) {
    stalled.push_back(std::make_unique<Browser>(io, server.port(), "/core.wasm"));
    for (int turns = 0; turns < 10; ++turns) turn();
  }
  EXPECT_EQ(server.broadcaster.connections(), 3U);
  ASSERT_TRUE(ends(*stalled[0]));
  EXPECT_LT(stalled[0]->bodyBytes(), kLarge_bytes);
  ASSERT_TRUE(ends(*stalled[3]));
  EXPECT_EQ(stalled[3]->bodyBytes(), kLarge_bytes);
}

TEST_F(PageRequestsTest, TheEndOfTheServerEndsAnswers) {
  TestServer server(io, clock, smallBuffers(), 0, "127.0.0.1", std::nullopt, files_);
  Browser browser(io, server.port(), "/core.wasm");
  ASSERT_TRUE(runUntil([&] { return server.broadcaster.counts().bytes > 0; }));
  server.stop();
  io.restart();
  EXPECT_TRUE(runUntil([&] { return io.stopped(); }));
}

}  // namespace
}  // namespace hapticast::testing
