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

/// Parses the request at the begin of `bytes`, removes it and returns it. If the bytes are no valid
/// request, or exceed kMaxHead_bytes, sets `error`; the returned request is then meaningless.
/// Returns nullopt if the request has not arrived completely. Each call parses the bytes from the
/// begin, so the result does not depend on how the bytes were split on arrival. (Beast's own loops
/// apply the limit to each part alone.) Requires: bytes.max_size() is kMaxHead_bytes.
[[nodiscard]] std::optional<HttpRequest> readRequest(boost::beast::flat_buffer& bytes,
                                                     boost::system::error_code& error);

}  // namespace hapticast::server
