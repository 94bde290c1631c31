// SPDX-License-Identifier: MIT
// Responses of the HTTP port: maps each path to its content. Boost.Beast writes the responses.
// Thread: any.
#pragma once

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <functional>
#include <string>
#include <vector>

#include "server/http/http_request.hpp"
#include "server/http/metrics.hpp"

namespace hapticast::server {

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
