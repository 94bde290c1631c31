// SPDX-License-Identifier: MIT
// Answers of the HTTP port: which path shows what. Boost.Beast reads the requests and writes the
// responses. Thread: any.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "server/http/metrics.hpp"

namespace hapticast::server {

/// Largest size of a request line with its header fields.
inline constexpr std::size_t kMaxHead_bytes = 8192;

/// The head of one request.
struct HttpRequest {
  boost::beast::http::verb method = boost::beast::http::verb::unknown;
  std::string path;         ///< target without its query
  bool has_body = false;    ///< a body follows; the server reads none
  bool keep_alive = false;  ///< whether the client wants to send another request
};

/// Parses the request at the begin of `bytes`, removes it and returns it. Returns any
/// request with `error` if the bytes are no request, or more than kMaxHead_bytes. Returns nullopt
/// if the request has not arrived completely. Each call parses the bytes anew, so the result cannot
/// depend on the portions in which they arrive. (Beast's own loops forget the limit for each
/// portion.) Requires: bytes.max_size() is kMaxHead_bytes.
[[nodiscard]] std::optional<HttpRequest> readRequest(boost::beast::flat_buffer& bytes,
                                                     boost::system::error_code& error);

using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// Returns the response to `request`, or to bytes that are no request because of
/// `error`. The connection stays open if the request asks for it and
/// `may_stay_open` is true: see HttpResponse::keep_alive(). Calls `metrics` if the path needs the
/// figures.
[[nodiscard]] HttpResponse respond(const HttpRequest& request,
                                   const boost::system::error_code& error, bool may_stay_open,
                                   const std::function<Metrics()>& metrics);

}  // namespace hapticast::server
