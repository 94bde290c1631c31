// SPDX-License-Identifier: MIT
#include "server/page/page_responder.hpp"

#include <fmt/core.h>

#include <boost/beast/http/error.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <utility>

#include "common/text.hpp"
#include "server/http/host_names.hpp"
#include "server/http/http_request.hpp"
#include "server/page/page_policy.hpp"
#include "server/page/websocket_handshake.hpp"

namespace hapticast::server {

namespace {

namespace http = boost::beast::http;
using http::field;
using http::status;

constexpr std::string_view kStreamPath = "/stream";
// Browsers ask for it without a reason in the page.
constexpr std::string_view kIconPath = "/favicon.ico";
constexpr std::size_t kMostShown_bytes = 100;  // of a request's text, in a sentence
constexpr const char* kSecurityFields =
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n";

/// `body_bytes`: nullopt for an answer that has no body by its status.
std::string writeHead(status code, std::optional<std::size_t> body_bytes, std::string_view fields) {
  const auto reason = http::obsolete_reason(code);
  return fmt::format(
      "HTTP/1.1 {} {}\r\n{}{}Connection: close\r\n"
      "Content-Security-Policy: {}; frame-ancestors 'none'\r\n{}\r\n",
      static_cast<unsigned>(code), std::string_view(reason.data(), reason.size()), fields,
      body_bytes ? fmt::format("Content-Length: {}\r\n", *body_bytes) : "", kPagePolicy,
      kSecurityFields);
}

/// Returns an answer with one sentence, which is also the problem for the log. `fields`: more
/// fields of the head.
HttpAnswer refuse(status code, const std::string& sentence, std::string_view fields = "") {
  const auto text = std::make_shared<const std::string>(sentence + "\n");
  HttpAnswer answer;
  answer.head = writeHead(
      code, text->size(),
      fmt::format("{}Content-Type: text/plain; charset=utf-8\r\nCache-Control: no-store\r\n",
                  fields));
  answer.body = {reinterpret_cast<const std::uint8_t*>(text->data()), text->size()};
  answer.owner = text;
  answer.problem = fmt::format("HTTP {}: {}", static_cast<unsigned>(code), sentence);
  return answer;
}

std::string show(std::string_view text) { return sanitizeUtf8(text, kMostShown_bytes); }

/// Returns the value of a field that may stand in a head once at most; nullopt: it does not.
std::optional<std::string_view> findOnce(const HttpRequest& request, field name) {
  if (request.head.count(name) != 1) return std::nullopt;
  const auto text = request.head[name];
  return std::string_view(text.data(), text.size());
}

bool acceptsGzip(const HttpRequest& request) {
  for (const auto& [coding, parameters] : http::ext_list(request.head[field::accept_encoding])) {
    if (toLower({coding.data(), coding.size()}) != "gzip") continue;
    for (const auto& [name, value] : parameters) {
      if ((name == "q" || name == "Q") &&
          value.find_first_not_of("0.") == boost::beast::string_view::npos)
        return false;
    }
    return true;
  }
  return false;
}

bool isUnchanged(const HttpRequest& request, const PageFile& file) {
  const auto known = request.head[field::if_none_match];
  return known == "*" ||
         std::string_view(known.data(), known.size()).find(file.etag) != std::string_view::npos;
}

/// Returns why the page that opens a WebSocket may not, or nullopt if it may.
std::optional<HttpAnswer> checkOrigin(const HttpRequest& request, bool encrypted) {
  const auto origin = findOnce(request, field::origin);
  if (!origin)
    return refuse(status::forbidden, "Only a page opens this WebSocket: Origin is missing.");
  const std::string own = (encrypted ? "https://" : "http://") + request.host.value_or("");
  if (toLower(*origin) == toLower(own)) return std::nullopt;
  return refuse(status::forbidden,
                fmt::format("A page of {} may not open the stream of {}; a proxy in between must "
                            "pass Host on, and speak TLS to this server if it does to browsers.",
                            show(*origin), show(own)));
}

/// Returns why the handshake is no valid one, or nullopt if it is.
std::optional<HttpAnswer> checkHandshake(const HttpRequest& request) {
  constexpr const char* kUpgrade = "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n";
  if (!boost::beast::websocket::is_upgrade(request.head))
    return refuse(status::upgrade_required,
                  fmt::format("Here is a WebSocket ({}); the page is at /.", kSubprotocol),
                  kUpgrade);
  if (findOnce(request, field::sec_websocket_version) != "13")
    return refuse(status::upgrade_required, "Only version 13 of WebSockets is known here.",
                  kUpgrade);
  if (!isWebSocketKey(findOnce(request, field::sec_websocket_key).value_or("")))
    return refuse(status::bad_request, "Sec-WebSocket-Key is not 16 bytes in base64.");
  const auto offered = request.head[field::sec_websocket_protocol];
  const boost::beast::string_view own(kSubprotocol.data(), kSubprotocol.size());
  for (const auto& each : http::token_list(offered)) {
    if (each == own) return std::nullopt;
  }
  return refuse(
      status::bad_request,
      fmt::format("This server speaks {}, the page {}: load the page again.", kSubprotocol,
                  offered.empty() ? "nothing" : show({offered.data(), offered.size()})));
}

HttpAnswer openStream(const HttpRequest& request, bool encrypted) {
  if (auto refusal = checkHandshake(request)) return std::move(*refusal);
  if (auto refusal = checkOrigin(request, encrypted)) return std::move(*refusal);
  HttpAnswer answer;
  answer.head = fmt::format(
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Accept: {}\r\nSec-WebSocket-Protocol: {}\r\n\r\n",
      acceptWebSocketKey(*findOnce(request, field::sec_websocket_key)), kSubprotocol);
  answer.is_websocket = true;
  answer.for_this_machine = isLoopbackHost(request.host.value_or(""));
  return answer;
}

/// Returns the answer to a request for a file that is not there.
HttpAnswer showNoFile(const HttpRequest& request) {
  if (request.path == "/")
    return refuse(status::service_unavailable,
                  "This server was built without the page: install clang, lld, wasi-libc, "
                  "libc++-dev-wasm32, libclang-rt-dev-wasm32 and python3, and build again.");
  HttpAnswer answer = refuse(status::not_found, "There is no such file; the page is at /.");
  answer.problem = fmt::format("HTTP 404: there is no file {}", show(request.path));
  if (request.path == kIconPath) answer.problem.clear();
  return answer;
}

/// Parses a whole head. `error` is set if it is none.
HttpRequest parseHead(std::string_view head, boost::system::error_code& error) {
  boost::beast::flat_buffer buffer{kMaxHead_bytes};
  const std::string_view part = head.substr(0, kMaxHead_bytes);
  buffer.commit(boost::asio::buffer_copy(buffer.prepare(part.size()),
                                         boost::asio::buffer(part.data(), part.size())));
  const auto request = readRequest(buffer, error);
  if (!request && !error) error = http::error::partial_message;
  return request.value_or(HttpRequest());
}

}  // namespace

HttpAnswer PageResponder::respond(std::string_view head, bool encrypted) {
  boost::system::error_code error;
  const HttpRequest request = parseHead(head, error);
  if (error == http::error::header_limit)
    return refuse(status::request_header_fields_too_large, "The request is too large.");
  if (error || !request.host)
    return refuse(status::bad_request, "This is no request of HTTP/1.1 with one Host.");
  const bool is_head = request.method == http::verb::head;
  if (!is_head && request.method != http::verb::get)
    return refuse(status::method_not_allowed, "Only GET and HEAD are known here.",
                  "Allow: GET, HEAD\r\n");
  if (request.has_body)
    return refuse(status::bad_request, "Only requests without a body are known here.");
  HttpAnswer answer = answerGet(request, encrypted);
  if (is_head && !answer.is_websocket) answer.body = {};
  return answer;
}

HttpAnswer PageResponder::answerGet(const HttpRequest& request, bool encrypted) {
  if (!isOwnHost(*request.host, host_names_))
    return refuse(status::forbidden,
                  fmt::format("This server does not have the name {}; it accepts it with "
                              "--host-name NAME.",
                              show(*request.host)));
  if (request.path == kStreamPath) return openStream(request, encrypted);
  const PageFile* const file = findPageFile(request.path, files_);
  if (file == nullptr || (request.path == "/" && !isPageComplete(files_)))
    return showNoFile(request);
  if (!isUnchanged(request, *file)) return showFile(*file, acceptsGzip(request));
  HttpAnswer answer;
  answer.head = writeHead(status::not_modified, std::nullopt,
                          fmt::format("Vary: Accept-Encoding\r\nETag: W/{}\r\n"
                                      "Cache-Control: no-cache\r\n",
                                      file->etag));
  return answer;
}

HttpAnswer PageResponder::showFile(const PageFile& file, bool gzip) {
  HttpAnswer answer;
  if (gzip) {
    answer.body = file.gzipped;
  } else {
    const Content& content = findInflated(file);
    answer.body = *content;
    answer.owner = content;
  }
  answer.head = writeHead(
      status::ok, answer.body.size(),
      fmt::format("Content-Type: {}\r\n{}Vary: Accept-Encoding\r\n"
                  "ETag: W/{}\r\nCache-Control: no-cache\r\n",
                  file.content_type, gzip ? "Content-Encoding: gzip\r\n" : "", file.etag));
  return answer;
}

const PageResponder::Content& PageResponder::findInflated(const PageFile& file) {
  Content& content = inflated_[&file];
  if (!content) content = std::make_shared<const std::vector<std::uint8_t>>(inflate(file));
  return content;
}

}  // namespace hapticast::server
