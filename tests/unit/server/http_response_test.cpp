// SPDX-License-Identifier: MIT
#include "server/http/http_response.hpp"

#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/write.hpp>
#include <sstream>
#include <stdexcept>

namespace hapticast::server {
namespace {

/// Returns the response to the bytes `text`, of which the server's buffer has the first 8 KB.
HttpResponse respondTo(const std::string& text, bool may_stay_open = true) {
  boost::beast::flat_buffer bytes{kMaxHead_bytes};
  const std::size_t size = std::min(text.size(), kMaxHead_bytes);
  bytes.commit(boost::asio::buffer_copy(bytes.prepare(size), boost::asio::buffer(text, size)));
  boost::system::error_code error;
  const auto request = readRequest(bytes, error);
  if (!request) throw std::runtime_error("not a whole request: " + text);
  return respond(*request, error, may_stay_open, {"a", "figures.example"}, [] {
    Metrics metrics;
    metrics.uptime = std::chrono::seconds(1);
    return metrics;
  });
}

int readStatus(const std::string& text) { return static_cast<int>(respondTo(text).result_int()); }

std::string toText(const HttpResponse& response) {
  std::ostringstream text;
  text << response;
  return text.str();
}

std::string headOfSize(std::size_t size) {
  const std::string begin = "GET /metrics HTTP/1.1\r\nHost: a\r\nX: ";
  return begin + std::string(size - begin.size() - 4, 'x') + "\r\n\r\n";
}

TEST(HttpResponse, RefusesBytesThatAreNoRequest) {
  for (const std::string wrong :
       {"\x16\x03\x01\x02", "GET\r\n\r\n", "GET /metrics\r\n\r\n", "GET / HTTP/2.0\r\n\r\n",
        "GET / HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n",
        "GET / HTTP/1.1\r\nHost a\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nA: \x01\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n"})
    EXPECT_EQ(readStatus(wrong), 400) << wrong;
}

TEST(HttpResponse, LimitsTheHead) {
  EXPECT_EQ(readStatus(headOfSize(kMaxHead_bytes)), 200);
  EXPECT_EQ(readStatus(headOfSize(kMaxHead_bytes + 1)), 431);
  EXPECT_EQ(readStatus("GET /" + std::string(9000, 'a')), 431);
  EXPECT_EQ(readStatus(std::string(9000, 'a')), 431);
}

TEST(HttpResponse, DependsOnMethodPathAndBody) {
  for (const std::string path : {"/metrics", "/metrics?name=1", "/health", "/status.json"})
    EXPECT_EQ(readStatus(fmt::format("GET {} HTTP/1.1\r\nHost: a\r\n\r\n", path)), 200) << path;
  for (const std::string path : {"/", "/metrics/", "//metrics", "/Health", "*", "ftp://a/metrics"})
    EXPECT_EQ(readStatus(fmt::format("GET {} HTTP/1.1\r\nHost: a\r\n\r\n", path)), 404) << path;
  EXPECT_EQ(readStatus("GET /metrics HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\n\r\n"), 413);
  const HttpResponse wrong_method = respondTo("POST / HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(wrong_method.result_int(), 405U);
  EXPECT_EQ(wrong_method.at("Allow"), "GET, HEAD");
}

TEST(HttpResponse, RefusesEveryTransferCodingAndEndsTheConnection) {
  for (const std::string field :
       {"Transfer-Encoding: chunked", "Transfer-Encoding: xchunked", "transfer-encoding:identity",
        "Transfer-Encoding: gzip, chunked", "Transfer-Encoding:\tchunked",
        "Transfer-Encoding: ", "Transfer-Encoding: gzip\r\nTransfer-Encoding: chunked"}) {
    for (const std::string method : {"GET", "HEAD", "POST"}) {
      const HttpResponse response = respondTo(
          fmt::format("{} /health HTTP/1.1\r\nHost: a\r\n{}\r\n\r\nGET /health HTTP/1.1\r\n\r\n",
                      method, field));
      EXPECT_EQ(response.result_int(), 501U) << method << ' ' << field;
      EXPECT_FALSE(response.keep_alive()) << method << ' ' << field;
    }
  }
}

TEST(HttpResponse, IsTheSameForTheAbsoluteFormOfTheTarget) {
  const auto status = [](const std::string& target, const std::string& host) {
    return readStatus(fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", target, host));
  };
  EXPECT_EQ(status("http://a/health", "a"), 200);
  EXPECT_EQ(status("HTTP://A:9464/health?now", "a"), 200);
  EXPECT_EQ(status("http://a", "a"), 404);
  EXPECT_EQ(status("http://a?/health", "a"), 404);
  EXPECT_EQ(status("http://a/health", "evil.example"), 200) << "the target replaces the field";
  EXPECT_EQ(status("http://evil.example/health", "a"), 421);
  EXPECT_EQ(status("http://a@evil.example/health", "a"), 421);
  EXPECT_EQ(status("http:///health", "a"), 421);
  EXPECT_EQ(readStatus("GET http://a/health HTTP/1.1\r\n\r\n"), 400) << "the field is required";
}

TEST(HttpResponse, IsOnlyForRequestsToANameOfThisServer) {
  const auto ask = [](const std::string& host, const std::string& path = "/health") {
    return respondTo(fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\n\r\n", path, host));
  };
  for (const std::string host : {"a", "A:9464", "figures.example:80", "127.0.0.1:9464", "[::1]"})
    EXPECT_EQ(ask(host).result_int(), 200U) << host;
  for (const std::string path : {"/health", "/metrics", "/status.json", "/nothing"}) {
    const HttpResponse response = ask("evil.example", path);
    EXPECT_EQ(response.result_int(), 421U) << path;
    EXPECT_NE(response.body().find("--host-name"), std::string::npos) << response.body();
  }
  for (const std::string host : {"", "a b", "a.evil.example", "a:b"})
    EXPECT_EQ(ask(host).result_int(), 421U) << host;
  EXPECT_EQ(readStatus("GET /health HTTP/1.0\r\n\r\n"), 200) << "no browser asks so";
  EXPECT_EQ(readStatus("GET /health HTTP/1.0\r\nHost: evil.example\r\n\r\n"), 421);
}

TEST(HttpResponse, KeepsTheConnectionOpenForAClientThatAsksForIt) {
  const std::string get = "GET /health HTTP/1.1\r\nHost: a\r\n";
  EXPECT_TRUE(respondTo(get + "\r\n").keep_alive());
  EXPECT_FALSE(respondTo(get + "\r\n", false).keep_alive());
  EXPECT_FALSE(respondTo(get + "Connection: close\r\n\r\n").keep_alive());
  EXPECT_FALSE(respondTo(get + "Content-Length: 1\r\n\r\n").keep_alive());
  EXPECT_FALSE(respondTo("GET /health HTTP/1.0\r\n\r\n").keep_alive());
}

TEST(HttpResponse, OfHeadIsThatOfGetWithoutTheBody) {
  const std::string rest = " /metrics HTTP/1.1\r\nHost: a\r\n\r\n";
  const std::string whole = toText(respondTo("GET" + rest));
  const std::string head = toText(respondTo("HEAD" + rest));
  EXPECT_EQ(head, whole.substr(0, whole.find("\r\n\r\n") + 4));
  EXPECT_LT(head.size(), whole.size());
}

}  // namespace
}  // namespace hapticast::server
