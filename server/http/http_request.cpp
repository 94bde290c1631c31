// SPDX-License-Identifier: MIT
#include "server/http/http_request.hpp"

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <limits>
#include <string>
#include <string_view>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

namespace http = boost::beast::http;

constexpr unsigned kVersionWithHost = 11;

using RequestParser = http::request_parser<http::empty_body>;

/// Returns whether the head names its host as RFC 9112, section 3.2 asks: once in version 1.1.
bool hasValidHost(const RequestParser& parser) {
  const std::size_t hosts = parser.get().count(http::field::host);
  return hosts == 1 || (hosts == 0 && parser.get().version() < kVersionWithHost);
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
  request.head = head;
  request.method = head.method();
  request.path = target.substr(0, target.find('?'));
  request.has_coding = head.count(http::field::transfer_encoding) > 0;
  request.has_body = request.has_coding || parser.content_length().value_or(0) > 0;
  request.keep_alive = head.keep_alive();
  return request;
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

}  // namespace hapticast::server
