// SPDX-License-Identifier: MIT
#include "server/http/http_response.hpp"

#include <fmt/core.h>

#include <string_view>

namespace hapticast::server {

namespace {

constexpr std::string_view kPlainText = "text/plain; charset=utf-8";

/// A response before its transmission.
struct HttpContent {
  HttpStatus status = HttpStatus::kOk;
  std::string body;
  std::string_view type = kPlainText;
};

std::string_view reasonOf(HttpStatus status) {
  switch (status) {
    case HttpStatus::kOk:
      return "OK";
    case HttpStatus::kMalformed:
      return "Bad Request";
    case HttpStatus::kNotFound:
      return "Not Found";
    case HttpStatus::kMethodNotAllowed:
      return "Method Not Allowed";
    case HttpStatus::kContentTooLarge:
      return "Content Too Large";
    case HttpStatus::kHeadersTooLarge:
      return "Request Header Fields Too Large";
    case HttpStatus::kUnavailable:
      return "Service Unavailable";
  }
  return "";
}

HttpContent makeErrorContent(HttpStatus status, std::string_view why) {
  return {status, fmt::format("{}\n", why)};
}

HttpContent showHealth(const Metrics& metrics) {
  if (const auto problem = findProblem(metrics))
    return makeErrorContent(HttpStatus::kUnavailable, *problem);
  return {HttpStatus::kOk, "ok\n"};
}

HttpContent show(const HttpRequest& request, const std::function<Metrics()>& metrics) {
  if (request.method == HttpMethod::kOther)
    return makeErrorContent(HttpStatus::kMethodNotAllowed, "only GET and HEAD");
  if (request.has_body)
    return makeErrorContent(HttpStatus::kContentTooLarge, "a request has no body here");
  if (request.path == "/metrics")
    return {HttpStatus::kOk, writePrometheus(metrics()),
            "text/plain; version=0.0.4; charset=utf-8"};
  if (request.path == "/health") return showHealth(metrics());
  if (request.path == "/status.json")
    return {HttpStatus::kOk, writeStatus(metrics()), "application/json"};
  return makeErrorContent(HttpStatus::kNotFound, "there are /metrics, /health and /status.json");
}

std::string toBytes(const HttpContent& content, bool with_body, bool keep_alive) {
  const bool wrong_method = content.status == HttpStatus::kMethodNotAllowed;
  return fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\n"
      "X-Content-Type-Options: nosniff\r\n{}Connection: {}\r\n\r\n{}",
      static_cast<int>(content.status), reasonOf(content.status), content.type, content.body.size(),
      wrong_method ? "Allow: GET, HEAD\r\n" : "", keep_alive ? "keep-alive" : "close",
      with_body ? content.body : "");
}

}  // namespace

std::string respond(const HttpRequest& request, bool keep_alive,
                    const std::function<Metrics()>& metrics) {
  return toBytes(show(request, metrics), request.method != HttpMethod::kHead, keep_alive);
}

std::string respondToError(HttpStatus status) {
  const bool large = status == HttpStatus::kHeadersTooLarge;
  return toBytes(makeErrorContent(
                     status, large ? "the request is too large" : "this is no request of HTTP/1.1"),
                 true, false);
}

}  // namespace hapticast::server
