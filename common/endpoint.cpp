// SPDX-License-Identifier: MIT
#include "common/endpoint.hpp"

#include <arpa/inet.h>

#include <algorithm>

#include "common/text.hpp"

namespace hapticast {

namespace {

bool isPort(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Returns whether `text` is an IPv6 address without brackets, whose colons precede no port; a zone
/// is allowed.
bool isBareV6(std::string_view text) {
  in6_addr address{};
  const std::size_t zone = std::min(text.find('%'), text.size());
  const std::string numbers(text.substr(0, zone));
  return text.find(':', zone) == std::string_view::npos &&
         ::inet_pton(AF_INET6, numbers.c_str(), &address) == 1;
}

/// Moves the host from the front of `text` to `host`; the rest is empty or begins with ':'. Returns
/// false for an invalid host.
bool parseHost(std::string_view& text, std::string& host) {
  std::size_t size = std::min(text.find(':'), text.size());
  const bool brackets = text.starts_with('[');
  if (brackets) {
    size = text.find(']');
    if (size == std::string_view::npos) return false;
    host = text.substr(1, size - 1);
    text.remove_prefix(size + 1);
    return !host.empty() && (text.empty() || text.starts_with(':'));
  }
  if (isBareV6(text)) size = text.size();
  if (size > 0) host = text.substr(0, size);
  text.remove_prefix(size);
  return true;
}

}  // namespace

std::optional<Endpoint> parseEndpoint(std::string_view text, const Endpoint& otherwise) {
  Endpoint endpoint = otherwise;
  const std::string with_colon = isPort(text) ? ":" + std::string(text) : std::string(text);
  text = with_colon;
  if (text.empty() || !parseHost(text, endpoint.host)) return std::nullopt;
  if (endpoint.host.find_first_of(" \t/[]") != std::string::npos) return std::nullopt;
  if (text.empty()) return endpoint;
  const auto port = parseNumberInRange<std::uint16_t>(text.substr(1), 0, UINT16_MAX);
  if (!port) return std::nullopt;
  endpoint.port = *port;
  return endpoint;
}

bool isV6(const Endpoint& endpoint) { return endpoint.host.find(':') != std::string::npos; }

std::string toString(const Endpoint& endpoint) {
  return (isV6(endpoint) ? "[" + endpoint.host + "]" : endpoint.host) + ":" +
         std::to_string(endpoint.port);
}

}  // namespace hapticast
