// SPDX-License-Identifier: MIT
// Answers of the HTTP port: which path shows what, and the bytes of a response. Thread: any.
#pragma once

#include <functional>
#include <string>

#include "server/http/http_request.hpp"
#include "server/http/metrics.hpp"

namespace hapticast::server {

/// Returns the bytes of the response to `request`. They say that the connection stays open if
/// `keep_alive` is true. Calls `metrics` if the path needs the figures.
[[nodiscard]] std::string respond(const HttpRequest& request, bool keep_alive,
                                  const std::function<Metrics()>& metrics);
/// Returns the bytes of the response to bytes that are no request. It ends the connection.
[[nodiscard]] std::string respondToError(HttpStatus status);

}  // namespace hapticast::server
