// SPDX-License-Identifier: MIT
#include "common/endpoint.hpp"

#include <algorithm>

#include "common/text.hpp"

namespace hapticast {

std::optional<Endpoint> parseEndpoint(std::string_view text) {
  Endpoint endpoint;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) return std::nullopt;
    endpoint.host = text.substr(1, close - 1);
    text.remove_prefix(close + 1);
    if (!text.empty() && !text.starts_with(':')) return std::nullopt;
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    endpoint.host = text.substr(0, colon);
    text.remove_prefix(colon);
  }
  if (endpoint.host.empty() || endpoint.host.find_first_of(" \t/") != std::string::npos)
    return std::nullopt;
  if (text.empty()) return endpoint;
  const auto port = numberIn<std::uint16_t>(text.substr(1), 0, UINT16_MAX);
  if (!port) return std::nullopt;
  endpoint.port = *port;
  return endpoint;
}

std::string toString(const Endpoint& endpoint) {
  const bool v6 = endpoint.host.find(':') != std::string::npos;
  return (v6 ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

}  // namespace hapticast
