// SPDX-License-Identifier: MIT
// The requests of the HTTP port: the bytes in chunks of any size give the same requests and the
// same error at the end, and each request gets one whole response.
#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/write.hpp>
#include <cstdint>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "server/http/http_response.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::http {
namespace {

using namespace hapticast::server;

constexpr std::size_t kMostChunks = 100;

/// The responses, in order.
using Outcome = std::vector<std::string>;

Metrics metrics() {
  Metrics metrics;
  metrics.name = "a \"stream\"\n\xFF";
  return metrics;
}

/// One response: its head ends, and the length in it is that of the body, which HEAD leaves out.
void check(const std::string& response, bool with_body) {
  const std::size_t end = response.find("\r\n\r\n");
  require(response.starts_with("HTTP/1.1 ") && end != std::string::npos);
  const std::string field = "Content-Length: ";
  const std::size_t at = response.find(field);
  require(at < end);
  const std::size_t body = response.size() - end - 4;
  const std::size_t length = std::stoul(response.substr(at + field.size()));
  require(length > 0 && body == (with_body ? length : 0));
}

namespace http = boost::beast::http;

/// Moves at most `chunk` bytes of `stream` into `buffer`, as far as there is room.
void feed(boost::beast::flat_buffer& buffer, std::span<const std::uint8_t>& stream,
          std::size_t chunk) {
  const std::size_t room = buffer.max_size() - buffer.size();
  const auto part = stream.first(std::min({chunk, stream.size(), room}));
  buffer.commit(boost::asio::buffer_copy(buffer.prepare(part.size()),
                                         boost::asio::buffer(part.data(), part.size())));
  stream = stream.subspan(part.size());
}

Outcome read(std::span<const std::uint8_t> stream, std::size_t chunk) {
  boost::beast::flat_buffer buffer{kMaxHead_bytes};
  Outcome outcome;
  for (;;) {
    boost::system::error_code error;
    const auto request = readRequest(buffer, error);
    if (!request && stream.empty()) return outcome;
    if (!request) {
      feed(buffer, stream, chunk);
      continue;
    }
    const HttpResponse response = respond(*request, error, true, {"a"}, metrics);
    std::ostringstream text;
    text << response;
    outcome.push_back(text.str());
    check(outcome.back(), error || request->method != http::verb::head);
    if (!response.keep_alive()) return outcome;
  }
}

}  // namespace

HAPTICAST_FUZZ_TARGET("http") {
  const std::span stream(data, size);
  const Outcome whole = read(stream, std::max<std::size_t>(size, 1));
  // Each chunk costs another parse, so long inputs have longer ones.
  for (const std::size_t chunk : {1U, 7U, 4096U})
    require(read(stream, std::max(chunk, size / kMostChunks)) == whole);
  return 0;
}

}  // namespace hapticast::fuzz::http
