// SPDX-License-Identifier: MIT
#include "common/transport/network_interfaces.hpp"

#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>

namespace hapticast {

namespace {

std::optional<asio::ip::address> toAddress(const sockaddr* from) {
  if (from == nullptr) return std::nullopt;
  asio::ip::udp::endpoint endpoint;
  if (from->sa_family == AF_INET) {
    std::memcpy(endpoint.data(), from, sizeof(sockaddr_in));
  } else if (from->sa_family == AF_INET6) {
    endpoint = {asio::ip::udp::v6(), 0};
    std::memcpy(endpoint.data(), from, sizeof(sockaddr_in6));
  } else {
    return std::nullopt;
  }
  return endpoint.address();
}

}  // namespace

bool NetworkInterface::hasName(const std::string& text) const {
  boost::system::error_code no_address;
  const auto wanted = asio::ip::make_address(text, no_address);
  return name == text || (!no_address && wanted == address);
}

std::vector<NetworkInterface> networkInterfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<NetworkInterface> found;
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    const auto address = toAddress(each->ifa_addr);
    if (!address || (each->ifa_flags & IFF_UP) == 0) continue;
    found.push_back({each->ifa_name, if_nametoindex(each->ifa_name), *address,
                     (each->ifa_flags & IFF_LOOPBACK) != 0});
  }
  std::stable_partition(found.begin(), found.end(),
                        [](const auto& each) { return !each.loopback; });
  return found;
}

}  // namespace hapticast
