// SPDX-License-Identifier: MIT
#include "server/http/http_request.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <limits>
#include <string_view>

namespace hapticast::server {

namespace {

namespace http = boost::beast::http;
using RequestParser = http::request_parser<http::empty_body>;

constexpr unsigned kHttp11 = 11;

HttpMethod convertMethod(http::verb verb) {
  if (verb == http::verb::get) return HttpMethod::kGet;
  return verb == http::verb::head ? HttpMethod::kHead : HttpMethod::kOther;
}

HttpRequest describeRequest(const RequestParser& parser) {
  const auto& head = parser.get();
  const std::string_view target(head.target().data(), head.target().size());
  return {convertMethod(head.method()), std::string(target.substr(0, target.find('?'))),
          parser.chunked() || parser.content_length().value_or(0) > 0, head.keep_alive()};
}

}  // namespace

Result<std::optional<HttpRequest>, HttpStatus> HttpRequestReader::next() {
  if (bytes_.empty()) return std::optional<HttpRequest>();
  // Each call parses the waiting bytes anew: the result cannot depend on their portions.
  RequestParser parser;
  parser.header_limit(kMaxHead_bytes);
  parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // bodies are not read
  parser.eager(false);
  boost::system::error_code error;
  const std::size_t used = parser.put(boost::asio::buffer(bytes_, kMaxHead_bytes), error);
  if (error == http::error::header_limit) return HttpStatus::kHeadersTooLarge;
  if (error && error != http::error::need_more) return HttpStatus::kMalformed;
  if (!parser.is_header_done()) {
    if (bytes_.size() >= kMaxHead_bytes) return HttpStatus::kHeadersTooLarge;
    return std::optional<HttpRequest>();
  }
  bytes_.erase(0, used);
  // RFC 9112, section 3.2: exactly one host in version 1.1.
  const auto& head = parser.get();
  const std::size_t hosts = head.count(http::field::host);
  if (hosts > 1 || (hosts == 0 && head.version() >= kHttp11)) return HttpStatus::kMalformed;
  return std::optional(describeRequest(parser));
}

}  // namespace hapticast::server
