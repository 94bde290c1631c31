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
  return respond(*request, error, may_stay_open, [] {
    Metrics metrics;
    metrics.uptime = std::chrono::seconds(1);
    return metrics;
  });
}

int readStatus(const std::string& text) { return static_cast<int>(respondTo(text).result_int()); }

std::string toText(HttpResponse response) {
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
  for (const std::string path : {"/", "/metrics/", "//metrics", "/Health", "*", "http://a/metrics"})
    EXPECT_EQ(readStatus(fmt::format("GET {} HTTP/1.1\r\nHost: a\r\n\r\n", path)), 404) << path;
  for (const std::string field : {"Content-Length: 1", "Transfer-Encoding: chunked"})
    EXPECT_EQ(readStatus(fmt::format("GET /metrics HTTP/1.1\r\nHost: a\r\n{}\r\n\r\n", field)), 413)
        << field;
  const HttpResponse wrong_method = respondTo("POST / HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(wrong_method.result_int(), 405U);
  EXPECT_EQ(wrong_method.at("Allow"), "GET, HEAD");
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
