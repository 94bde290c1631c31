// SPDX-License-Identifier: MIT
// Heads of requests of HTTP, parsed by Boost.Beast: for the HTTP port of operators, and for the
// page on the port of the viewers. Thread: any.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <cstddef>
#include <optional>
#include <string>

#include "common/transport/http_responder.hpp"

namespace hapticast::server {

/// Largest size of a request line with its header fields.
inline constexpr std::size_t kMaxHead_bytes = HttpHead::kMostBytes;

/// The head of one request.
struct HttpRequest {
  boost::beast::http::verb method = boost::beast::http::verb::unknown;
  std::string path;                 ///< target without its query
  std::optional<std::string> host;  ///< HOST or HOST:PORT of the target; nullopt: not stated
  bool has_body = false;            ///< a body follows; the server reads none
  bool has_coding = false;          ///< the body has a transfer coding, so its end is unknown
  bool keep_alive = false;          ///< the client asks to keep the connection open
  boost::beast::http::request_header<> head;  ///< request line and all fields
};

/// Parses the head of a request at the begin of `bytes`. Returns nullopt if the head is not
/// complete; `error` then has no meaning, and a later call with more bytes parses from the begin
/// again. Returns the request, and removes its head from `bytes`, if the head is valid. Sets
/// `error` if it is not valid, or is longer than kMaxHead_bytes; the returned request then has no
/// meaning. Requires: bytes.max_size() is kMaxHead_bytes.
[[nodiscard]] std::optional<HttpRequest> readRequest(boost::beast::flat_buffer& bytes,
                                                     boost::system::error_code& error);

}  // namespace hapticast::server
