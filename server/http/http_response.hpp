// SPDX-License-Identifier: MIT
// Answers of the HTTP port: which path shows what. Boost.Beast reads the requests and writes the
// responses. Thread: any.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstddef>
#include <functional>
#include <optional>

#include "server/http/metrics.hpp"

namespace hapticast::server {

/// Largest size of a request line with its header fields.
inline constexpr std::size_t kMaxHead_bytes = 8192;

/// Reads the head of one request. The server reads no bodies.
class HttpRequestParser
    : public boost::beast::http::request_parser<boost::beast::http::empty_body> {
 public:
  HttpRequestParser();
  /// Returns whether a body follows the head. Requires: the head is complete.
  [[nodiscard]] bool hasBody() const;
};

/// Parses the request at the begin of `bytes`, removes it and returns it. Returns a parser with
/// `error` if the bytes are no request, or more than kMaxHead_bytes. Returns nullopt if the request
/// has not arrived completely. Each call parses the bytes anew, so the result cannot depend on the
/// portions in which they arrive. (Beast's own loops forget the limit for each portion.)
/// Requires: bytes.max_size() is kMaxHead_bytes.
[[nodiscard]] std::optional<HttpRequestParser> readRequest(boost::beast::flat_buffer& bytes,
                                                           boost::system::error_code& error);

using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// Returns the response to the request in `parser`, or to bytes that are no request because of
/// `error`. The connection stays open if the request asks for it and
/// `may_stay_open` is true: see HttpResponse::keep_alive(). Calls `metrics` if the path needs the
/// figures.
[[nodiscard]] HttpResponse respond(const HttpRequestParser& parser,
                                   const boost::system::error_code& error, bool may_stay_open,
                                   const std::function<Metrics()>& metrics);

}  // namespace hapticast::server
