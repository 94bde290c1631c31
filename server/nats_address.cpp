// SPDX-License-Identifier: MIT
#include "server/nats_address.hpp"

#include "common/text.hpp"

namespace hapticast::server {

bool isChannelName(std::string_view name) {
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  return !name.empty() && name.size() <= kMostChannelBytes &&
         name.find_first_not_of(kAllowed) == std::string_view::npos;
}

std::optional<NatsAddress> parseNatsAddress(std::string_view text) {
  if (!text.starts_with(kNatsScheme)) return std::nullopt;
  text.remove_prefix(kNatsScheme.size());
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  NatsAddress address;
  address.channel = text.substr(slash + 1);
  if (!isChannelName(address.channel)) return std::nullopt;
  std::string_view servers = text.substr(0, slash);
  while (true) {
    const std::size_t comma = servers.find(',');
    const auto server = parseEndpoint(servers.substr(0, comma), Endpoint{"", kNatsPort});
    if (!server || server->host.empty() || server->port == 0) return std::nullopt;
    address.servers.push_back(*server);
    if (comma == std::string_view::npos) return address;
    servers.remove_prefix(comma + 1);
  }
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
