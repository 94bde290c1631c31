// SPDX-License-Identifier: MIT
#include "server/relay/nats_address.hpp"

#include <charconv>
#include <system_error>

#include "common/text.hpp"

namespace hapticast::server {

bool isChannelName(std::string_view name) {
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  return !name.empty() && name.size() <= kMostChannelBytes &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

namespace {

/// Returns `text` with its percent-encoded characters decoded (RFC 3986, 2.1); nullopt if '%' is
/// not followed by two hex digits.
std::optional<std::string> decodePercent(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned value = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (digits.size() != 2 || error != std::errc() || end != digits.data() + 2) return std::nullopt;
    decoded += static_cast<char>(value);
    i += 2;
  }
  return decoded;
}

/// Reads USER:PASSWORD into `address`. Returns false if `text` is not of this form.
bool readUser(std::string_view text, NatsAddress& address) {
  const std::size_t colon = text.find(':');
  const auto user = decodePercent(text.substr(0, colon));
  if (!user || user->empty()) return false;
  address.user = *user;
  if (colon == std::string_view::npos) return true;
  address.password = decodePercent(text.substr(colon + 1));
  return address.password.has_value();
}

}  // namespace

std::optional<NatsAddress> parseNatsAddress(std::string_view text) {
  if (!text.starts_with(kNatsScheme)) return std::nullopt;
  text.remove_prefix(kNatsScheme.size());
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  NatsAddress address;
  address.channel = text.substr(slash + 1);
  if (!isChannelName(address.channel)) return std::nullopt;
  std::string_view servers = text.substr(0, slash);
  if (const std::size_t at = servers.find('@'); at != std::string_view::npos) {
    if (!readUser(servers.substr(0, at), address)) return std::nullopt;
    servers.remove_prefix(at + 1);
  }
  if (servers.find('@') != std::string_view::npos) return std::nullopt;
  while (true) {
    const std::size_t comma = servers.find(',');
    const auto server = parseEndpoint(servers.substr(0, comma), Endpoint{"", kNatsPort});
    if (!server || server->host.empty() || server->port == 0) return std::nullopt;
    address.servers.push_back(*server);
    if (comma == std::string_view::npos) return address;
    servers.remove_prefix(comma + 1);
  }
}

std::string hideUser(std::string_view text) {
  constexpr std::string_view kAfterScheme = "://";
  const std::size_t at = text.rfind('@');
  if (at == std::string_view::npos) return std::string(text);
  const std::size_t scheme = text.find(kAfterScheme);
  std::string shown(
      text.substr(0, scheme == std::string_view::npos ? 0 : scheme + kAfterScheme.size()));
  return shown += text.substr(at + 1);
}

std::string toString(const NatsAddress& address) {
  std::vector<std::string> servers;
  servers.reserve(address.servers.size());
  for (const Endpoint& server : address.servers) servers.push_back(toString(server));
  std::string text(kNatsScheme);
  text += join(servers, ",");
  text += '/';
  text += address.channel;
  return text;
}

}  // namespace hapticast::server
