// SPDX-License-Identifier: MIT
// The HTTP port's reader of requests: however the bytes are cut into chunks, the same requests come
// out and the same error ends them, and each gets one whole response.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/http/http_response.hpp"

namespace {

using namespace hapticast::server;

void require(bool condition) {
  if (!condition) std::abort();
}

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

Outcome read(std::span<const std::uint8_t> stream, std::size_t chunk) {
  HttpRequestReader reader;
  Outcome outcome;
  while (!stream.empty()) {
    const auto size = std::min(chunk, stream.size());
    reader.feed(stream.first(size));
    stream = stream.subspan(size);
    for (;;) {
      const auto next = reader.next();
      if (!next.ok()) {
        outcome.push_back(respondToError(next.error()));
        check(outcome.back(), true);
        return outcome;
      }
      if (!next.value()) break;
      const HttpRequest& request = *next.value();
      outcome.push_back(respond(request, request.keep_alive, metrics));
      check(outcome.back(), request.method != HttpMethod::kHead);
      if (request.has_body || !request.keep_alive) return outcome;
    }
  }
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span stream(data, size);
  const Outcome whole = read(stream, std::max<std::size_t>(size, 1));
  // Each chunk costs another parse, so long inputs have longer ones.
  for (const std::size_t chunk : {1U, 7U, 4096U})
    require(read(stream, std::max(chunk, size / kMostChunks)) == whole);
  return 0;
}
