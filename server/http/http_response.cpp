// SPDX-License-Identifier: MIT
#include "server/http/http_response.hpp"

#include <algorithm>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <limits>
#include <string>
#include <string_view>

#include "common/text.hpp"
#include "server/http/host_names.hpp"

namespace hapticast::server {

namespace {

namespace http = boost::beast::http;
using http::status;

constexpr unsigned kHttp11 = 11;

using RequestParser = http::request_parser<http::empty_body>;

/// Returns whether the head names its host as RFC 9112, section 3.2 asks: once in version 1.1.
bool hasValidHost(const RequestParser& parser) {
  const std::size_t hosts = parser.get().count(http::field::host);
  return hosts == 1 || (hosts == 0 && parser.get().version() < kHttp11);
}

/// Removes the scheme and the host from `target` and returns the host, if `target` has the absolute
/// form (RFC 9112, section 3.2.2), such as http://HOST/health.
std::optional<std::string> removeHost(std::string_view& target) {
  constexpr std::string_view kScheme = "http://";
  if (toLower(target.substr(0, kScheme.size())) != kScheme) return std::nullopt;
  target.remove_prefix(kScheme.size());
  const std::string_view host = target.substr(0, target.find_first_of("/?"));
  target.remove_prefix(host.size());
  if (!target.starts_with('/')) target = "/";  // a page without a path; its query has no meaning
  return std::string(host);
}

HttpRequest describeRequest(const RequestParser& parser) {
  const auto& head = parser.get();
  HttpRequest request;
  std::string_view target(head.target().data(), head.target().size());
  request.host = removeHost(target);
  if (const auto field = head.find(http::field::host); !request.host && field != head.end())
    request.host = std::string(field->value());
  request.method = head.method();
  request.path = target.substr(0, target.find('?'));
  request.has_coding = head.count(http::field::transfer_encoding) > 0;
  request.has_body = request.has_coding || parser.content_length().value_or(0) > 0;
  request.keep_alive = head.keep_alive();
  return request;
}

void setContent(HttpResponse& response, status code, std::string body,
                const char* type = "text/plain; charset=utf-8") {
  response.result(code);
  response.set(http::field::content_type, type);
  response.body() = std::move(body);
}

void showHealth(HttpResponse& response, const Metrics& metrics) {
  const auto problem = findProblem(metrics);
  setContent(response, problem ? status::service_unavailable : status::ok,
             problem.value_or("ok: " + describeActivity(metrics)) + "\n");
}

void show(HttpResponse& response, const HttpRequest& request,
          const std::vector<std::string>& host_names, const std::function<Metrics()>& metrics) {
  // RFC 9112, section 6.1. What follows must not count as another request.
  if (request.has_coding)
    return setContent(response, status::not_implemented, "there is no transfer coding here\n");
  if (request.host && !isOwnHost(*request.host, host_names))
    return setContent(response, status::misdirected_request,
                      "this server does not have this name; it accepts it with --host-name NAME\n");
  if (request.method != http::verb::get && request.method != http::verb::head) {
    response.set(http::field::allow, "GET, HEAD");
    return setContent(response, status::method_not_allowed, "only GET and HEAD\n");
  }
  if (request.has_body)
    return setContent(response, status::payload_too_large, "a request has no body here\n");
  if (request.path == "/metrics")
    return setContent(response, status::ok, writePrometheus(metrics()),
                      "text/plain; version=0.0.4; charset=utf-8");
  if (request.path == "/health") return showHealth(response, metrics());
  if (request.path == "/status.json")
    return setContent(response, status::ok, writeStatus(metrics()), "application/json");
  setContent(response, status::not_found, "there are /metrics, /health and /status.json\n");
}

}  // namespace

std::optional<HttpRequest> readRequest(boost::beast::flat_buffer& bytes,
                                       boost::system::error_code& error) {
  if (bytes.size() == 0) return std::nullopt;
  RequestParser parser;
  parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // bodies are not read
  const std::size_t used = parser.put(bytes.data(), error);
  if (parser.is_header_done()) {
    bytes.consume(used);
    if (!hasValidHost(parser)) error = http::error::bad_field;
    return describeRequest(parser);
  }
  if (error == http::error::need_more) {
    if (bytes.size() < bytes.max_size()) return std::nullopt;
    error = http::error::header_limit;
  }
  return HttpRequest();
}

HttpResponse respond(const HttpRequest& request, const boost::system::error_code& error,
                     bool may_stay_open, const std::vector<std::string>& host_names,
                     const std::function<Metrics()>& metrics) {
  HttpResponse response(status::ok, kHttp11);
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  if (error == http::error::header_limit) {
    setContent(response, status::request_header_fields_too_large, "the request is too large\n");
  } else if (error) {
    setContent(response, status::bad_request, "this is no request of HTTP/1.1\n");
  } else {
    show(response, request, host_names, metrics);
  }
  const bool stays = !error && may_stay_open && request.keep_alive && !request.has_body;
  response.set(http::field::connection, stays ? "keep-alive" : "close");
  response.content_length(response.body().size());
  if (!error && request.method == http::verb::head) response.body().clear();
  return response;
}

}  // namespace hapticast::server
