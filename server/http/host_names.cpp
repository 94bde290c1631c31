// SPDX-License-Identifier: MIT
#include "server/http/host_names.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "common/text.hpp"

namespace hapticast::server {

namespace {

bool isAddress(int family, std::string_view text) {
  in6_addr address{};  // has room for one of IPv4, too
  return ::inet_pton(family, std::string(text).c_str(), &address) == 1;
}

/// Returns whether `text` is what may follow a host: nothing, or a colon with the digits of a port.
bool isPortSuffix(std::string_view text) {
  return text.empty() ||
         (text.front() == ':' && text.find_first_not_of("0123456789", 1) == std::string_view::npos);
}

}  // namespace

std::vector<std::string> listHostNames(const std::string& machine,
                                       const std::vector<std::string>& more) {
  std::vector<std::string> names{"localhost"};
  const std::string label = machine.substr(0, machine.find('.'));
  if (!label.empty()) names.insert(names.end(), {machine, label, label + ".local"});
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

std::string findMachineName() {
  std::array<char, 256> name{};  // the last byte stays 0
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

bool isOwnHost(std::string_view authority, const std::vector<std::string>& names) {
  if (authority.find('\0') != std::string_view::npos) return false;
  if (authority.starts_with('[')) {
    const std::size_t end = authority.find(']');
    return end != std::string_view::npos && isAddress(AF_INET6, authority.substr(1, end - 1)) &&
           isPortSuffix(authority.substr(end + 1));
  }
  const std::size_t end = std::min(authority.find(':'), authority.size());
  const std::string host = toLower(authority.substr(0, end));
  if (!isPortSuffix(authority.substr(end))) return false;
  return isAddress(AF_INET, host) || std::any_of(names.begin(), names.end(), [&](const auto& name) {
           return toLower(name) == host;
         });
}

bool isLoopbackHost(std::string_view authority) {
  const std::string host = toLower(authority.substr(
      0, authority.starts_with('[') ? authority.find(']') + 1 : authority.find(':')));
  return host == "localhost" || host == "[::1]" ||
         (host.starts_with("127.") && isAddress(AF_INET, host));
}

}  // namespace hapticast::server
