// SPDX-License-Identifier: MIT
#include "server/page/page_link.hpp"

#include <algorithm>

#include "common/endpoint.hpp"

namespace hapticast::server {

namespace {

/// Returns the address of `interfaces` that is easiest to reach and to type, or nullptr.
const NetworkInterface* findReachable(const asio::ip::address& listens,
                                      std::span<const NetworkInterface> interfaces) {
  const auto find = [&](auto is_wanted) {
    const auto found = std::find_if(interfaces.begin(), interfaces.end(), [&](const auto& each) {
      return !each.loopback && is_wanted(each.address);
    });
    return found == interfaces.end() ? nullptr : &*found;
  };
  constexpr unsigned kLinkLocal = 0xA9FE;  // 169.254.0.0/16 (RFC 3927)
  const auto* const v4 = find([](const asio::ip::address& each) {
    return each.is_v4() && each.to_v4().to_uint() >> 16U != kLinkLocal;
  });
  if (v4 != nullptr || listens.is_v4()) return v4;
  return find(
      [](const asio::ip::address& each) { return each.is_v6() && !each.to_v6().is_link_local(); });
}

}  // namespace

std::string makePageLink(const asio::ip::tcp::endpoint& endpoint, bool tls,
                         std::span<const NetworkInterface> interfaces) {
  std::string host = unmapAddress(endpoint.address()).to_string();
  if (endpoint.address().is_unspecified()) {
    const NetworkInterface* const found = findReachable(endpoint.address(), interfaces);
    host = found != nullptr ? found->address.to_string() : "localhost";
  }
  return (tls ? "https://" : "http://") + toString(Endpoint{host, endpoint.port()}) + "/";
}

}  // namespace hapticast::server
