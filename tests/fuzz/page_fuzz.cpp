// SPDX-License-Identifier: MIT
// Requests of HTTP on the port of the viewers: the head ends at the same byte however it is cut,
// and each head gets one whole answer. Only a request that names this server and its page becomes a
// WebSocket.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/page/page_responder.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::page {
namespace {

using namespace hapticast;

constexpr std::size_t kMostChunks = 100;

/// A whole head, or nothing if the bytes end before; and the bytes behind it.
struct Split {
  bool whole = false;
  std::string head;
  std::vector<std::uint8_t> rest;
};

Split split(std::span<const std::uint8_t> stream, std::size_t chunk) {
  HttpHead head;
  Split out;
  while (!out.whole && !stream.empty()) {
    const auto part = stream.first(std::min(chunk, stream.size()));
    stream = stream.subspan(part.size());
    out.whole = head.add(part);
  }
  if (!out.whole) return out;
  out.head = head.text();
  out.rest.assign(head.rest().begin(), head.rest().end());
  out.rest.insert(out.rest.end(), stream.begin(), stream.end());
  return out;
}

void check(const HttpAnswer& answer) {
  require(answer.head.starts_with("HTTP/1.1 ") && answer.head.ends_with("\r\n\r\n"));
  require(answer.head.find("\r\n\r\n") == answer.head.size() - 4);
  if (answer.is_websocket) {
    require(answer.body.empty() && answer.head.starts_with("HTTP/1.1 101 "));
    return;
  }
  const std::string length = "\r\nContent-Length: " + std::to_string(answer.body.size()) + "\r\n";
  const bool unchanged =
      answer.head.starts_with("HTTP/1.1 304 ");  // its length would be the file's
  require((answer.head.find(length) != std::string::npos) != unchanged);
  require(answer.head.find("\r\nConnection: close\r\n") != std::string::npos);
  require(answer.problem.find('\n') == std::string::npos);
}

}  // namespace

HAPTICAST_FUZZ_TARGET("page") {
  // The content of the files does not matter: gzip of an empty text.
  static const std::vector<std::uint8_t> empty{0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 2, 3,
                                               3,    0,    0, 0, 0, 0, 0, 0, 0, 0};
  static const std::vector<server::PageFile> files{
      {"index.html", "text/html", empty, "\"1\""},
      {"core.wasm", "application/wasm", empty, "\"2\""}};
  const std::span stream(data, size);
  const Split whole = split(stream, std::max<std::size_t>(size, 1));
  for (const std::size_t chunk : {1U, 7U}) {
    const Split other = split(stream, std::max(chunk, size / kMostChunks));
    require(other.whole == whole.whole);
    // A head above the limit is cut at another place, but the answer is the same.
    if (whole.head.size() <= HttpHead::kMostBytes)
      require(other.head == whole.head && other.rest == whole.rest);
  }
  if (!whole.whole) return 0;
  server::PageResponder page({"lab"}, files);
  for (const bool encrypted : {false, true}) check(page.respond(whole.head, encrypted));
  return 0;
}

}  // namespace hapticast::fuzz::page
