// SPDX-License-Identifier: MIT
#include "server/http/http_request.hpp"

#include <gtest/gtest.h>

#include "server/http/http_response.hpp"

namespace hapticast::server {
namespace {

using Next = Result<std::optional<HttpRequest>, HttpStatus>;

std::span<const std::uint8_t> toBytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Next readOne(const std::string& text) {
  HttpRequestReader reader;
  reader.feed(toBytes(text));
  return reader.next();
}

/// The status of what is no request, or 0.
int statusOf(const std::string& text) {
  const auto next = readOne(text);
  return next.ok() ? 0 : static_cast<int>(next.error());
}

std::string headOfSize(std::size_t size) {
  const std::string begin = "GET /metrics HTTP/1.1\r\nHost: a\r\nX: ";
  return begin + std::string(size - begin.size() - 4, 'x') + "\r\n\r\n";
}

TEST(HttpRequestReader, ReadsRequestsThatArriveInPortions) {
  const std::string text =
      "GET /metrics?name=1 HTTP/1.1\r\nHost: a\r\n\r\nHEAD / HTTP/1.0\r\n\r\nPUT /x HTTP/1.1\r\n"
      "Host: a\r\nContent-Length: 1\r\nConnection: close\r\n\r\n";
  HttpRequestReader reader;
  std::vector<HttpRequest> requests;
  for (const char& each : text) {
    reader.feed({reinterpret_cast<const std::uint8_t*>(&each), 1});
    const auto next = reader.next();
    ASSERT_TRUE(next.ok());
    if (next.value()) requests.push_back(*next.value());
  }
  ASSERT_EQ(requests.size(), 3U);
  EXPECT_EQ(requests[0].method, HttpMethod::kGet);
  EXPECT_EQ(requests[0].path, "/metrics");
  EXPECT_TRUE(requests[0].keep_alive);
  EXPECT_FALSE(requests[0].has_body);
  EXPECT_EQ(requests[1].method, HttpMethod::kHead);
  EXPECT_FALSE(requests[1].keep_alive);
  EXPECT_EQ(requests[2].method, HttpMethod::kOther);
  EXPECT_TRUE(requests[2].has_body);
  EXPECT_FALSE(requests[2].keep_alive);
}

TEST(HttpRequestReader, RefusesBytesThatAreNoRequest) {
  for (const std::string wrong :
       {"\x16\x03\x01\x02", "GET\r\n\r\n", "GET /metrics\r\n\r\n", "GET / HTTP/2.0\r\n\r\n",
        "GET / HTTP/1.1\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n",
        "GET / HTTP/1.1\r\nHost a\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nA: \x01\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\nTransfer-Encoding: chunked\r\n\r\n"})
    EXPECT_EQ(statusOf(wrong), 400) << wrong;
}

TEST(HttpRequestReader, LimitsTheHead) {
  EXPECT_TRUE(readOne(headOfSize(HttpRequestReader::kMaxHead_bytes)).ok());
  EXPECT_EQ(statusOf(headOfSize(HttpRequestReader::kMaxHead_bytes + 1)), 431);
  EXPECT_EQ(statusOf("GET /" + std::string(9000, 'a')), 431);
  EXPECT_EQ(statusOf(std::string(9000, 'a')), 431);
}

std::string responseTo(const HttpRequest& request) {
  return respond(request, true, [] {
    Metrics metrics;
    metrics.uptime = std::chrono::seconds(1);
    return metrics;
  });
}

TEST(HttpResponse, DependsOnMethodPathAndBody) {
  const auto begins = [](const HttpRequest& request, const std::string& line) {
    EXPECT_TRUE(responseTo(request).starts_with(line + "\r\n")) << responseTo(request);
  };
  for (const char* path : {"/metrics", "/health", "/status.json"})
    begins({HttpMethod::kGet, path}, "HTTP/1.1 200 OK");
  for (const char* path : {"/", "", "/metrics/", "//metrics", "/Health", "*", "http://a/metrics"})
    begins({HttpMethod::kGet, path}, "HTTP/1.1 404 Not Found");
  begins({HttpMethod::kOther, "/metrics"}, "HTTP/1.1 405 Method Not Allowed");
  begins({HttpMethod::kGet, "/metrics", true}, "HTTP/1.1 413 Content Too Large");
  EXPECT_NE(responseTo({HttpMethod::kOther, "/"}).find("\r\nAllow: GET, HEAD\r\n"),
            std::string::npos);
}

TEST(HttpResponse, OfHeadIsThatOfGetWithoutTheBody) {
  const std::string whole = responseTo({HttpMethod::kGet, "/metrics"});
  const std::string head = responseTo({HttpMethod::kHead, "/metrics"});
  EXPECT_EQ(head, whole.substr(0, whole.find("\r\n\r\n") + 4));
  EXPECT_LT(head.size(), whole.size());
}

}  // namespace
}  // namespace hapticast::server
