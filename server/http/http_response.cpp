// SPDX-License-Identifier: MIT
#include "server/http/http_response.hpp"

#include <boost/beast/http/error.hpp>
#include <string>
#include <string_view>

#include "server/http/host_names.hpp"

namespace hapticast::server {

namespace {

namespace http = boost::beast::http;
using http::status;

constexpr unsigned kHttp11 = 11;

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
