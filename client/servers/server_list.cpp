// SPDX-License-Identifier: MIT
#include "client/servers/server_list.hpp"

#include <algorithm>
#include <tuple>

#include "common/mdns.hpp"
#include "common/protocol/messages.hpp"
#include "common/text.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {

namespace {

auto identity(const FoundServer& server) {
  return std::tie(server.name, server.host, server.address.port);
}

std::string formatVersion(const FoundServer& server) {
  if (server.version == kProtocolVersion) return "";
  if (server.version == 0) return "  (protocol version not announced)";
  return "  (protocol version " + std::to_string(server.version) + ", this client " +
         std::to_string(kProtocolVersion) + ")";
}

std::string formatInOneLine(const FoundServer& server) {
  constexpr std::size_t kMaxHost_bytes = 64;  // chosen; a name of DNS may have 255
  const std::string plays = sanitizeUtf8(server.plays, kMaxServicePlays_bytes);
  std::string line = "  " + sanitizeUtf8(server.name, kMaxServiceName_bytes) + "  at ";
  line.append(sanitizeUtf8(server.host, kMaxHost_bytes)).append("  ");
  line.append(toString(server.address)).append("  ").append(server.interface_name);
  if (!plays.empty()) line.append("  plays ").append(plays);
  if (parseKey(server.tls)) line.append("  with TLS");
  return line.append(formatVersion(server));
}

}  // namespace

std::vector<FoundServer> removeDuplicates(std::vector<FoundServer> found) {
  const auto order = [](const FoundServer& server) {
    return std::tuple_cat(
        identity(server),
        std::make_tuple(isV6(server.address), server.interface_name, server.address.host));
  };
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return order(a) < order(b); });
  const auto same = [](const auto& a, const auto& b) { return identity(a) == identity(b); };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  return found;
}

std::optional<FoundServer> only(const std::vector<FoundServer>& found, const std::string& name,
                                std::string& why) {
  std::optional<FoundServer> the_one;
  for (const FoundServer& each : found) {
    if (each.name != name) continue;
    if (the_one) {
      why = "more than one host announces this name: " + toString(the_one->address) + ", " +
            toString(each.address);
      return std::nullopt;
    }
    the_one = each;
  }
  if (!the_one) why = "no server announces this name";
  return the_one;
}

std::string toText(const std::vector<FoundServer>& servers) {
  std::vector<std::string> lines;
  for (const FoundServer& server : servers) {
    if (lines.size() == kMaxListedServers) {
      lines.emplace_back("  and more, which are not shown");
      break;
    }
    lines.push_back(formatInOneLine(server));
  }
  return join(lines, "\n");
}

}  // namespace hapticast::client
