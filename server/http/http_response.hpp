// SPDX-License-Identifier: MIT
// Requests and responses of the HTTP port: maps each path to its content. Boost.Beast parses the
// requests and writes the responses. Thread: any.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/http/metrics.hpp"

namespace hapticast::server {

/// Largest size of a request line with its header fields.
inline constexpr std::size_t kMaxHead_bytes = 8192;

/// The head of one request.
struct HttpRequest {
  boost::beast::http::verb method = boost::beast::http::verb::unknown;
  std::string path;                 ///< target without its query
  std::optional<std::string> host;  ///< HOST or HOST:PORT of the target; nullopt: not stated
  bool has_body = false;            ///< a body follows; the server reads none
  bool has_coding = false;          ///< the body has a transfer coding, so its end is unknown
  bool keep_alive = false;          ///< the client asks to keep the connection open
};

/// Parses the request at the begin of `bytes`, removes it and returns it. If the bytes are no valid
/// request, or exceed kMaxHead_bytes, sets `error`; the returned request is then meaningless.
/// Returns nullopt if the request has not arrived completely. Each call parses the bytes from the
/// begin, so the result does not depend on how the bytes were split on arrival. (Beast's own loops
/// apply the limit to each part alone.) Requires: bytes.max_size() is kMaxHead_bytes.
[[nodiscard]] std::optional<HttpRequest> readRequest(boost::beast::flat_buffer& bytes,
                                                     boost::system::error_code& error);

using HttpResponse = boost::beast::http::response<boost::beast::http::string_body>;

/// Returns the response to `request`, or an error response if `error` is set. The request's host
/// must be an address or one of `host_names` (isOwnHost()). The connection stays open if the client
/// requested it, `may_stay_open` is true, and there is neither an error nor a body.
/// HttpResponse::keep_alive() of the result states whether it stays open. Calls `metrics` if the
/// path needs the figures.
[[nodiscard]] HttpResponse respond(const HttpRequest& request,
                                   const boost::system::error_code& error, bool may_stay_open,
                                   const std::vector<std::string>& host_names,
                                   const std::function<Metrics()>& metrics);

}  // namespace hapticast::server
