// SPDX-License-Identifier: MIT
#include "server/stream/multicast_group.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "common/text.hpp"
#include "server/stream/address_error.hpp"

namespace hapticast::server {

namespace {

/// An address of one of this machine's networks.
struct Interface {
  std::string name;
  asio::ip::address address;
  bool loopback = false;
};

std::optional<asio::ip::address> addressOf(const sockaddr* from) {
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

/// Those that are up and speak this version of IP; the loopback comes last.
std::vector<Interface> interfaces(bool v6) {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return {};
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<Interface> found;
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    const auto address = addressOf(each->ifa_addr);
    if (!address || address->is_v6() != v6 || (each->ifa_flags & IFF_UP) == 0) continue;
    found.push_back({each->ifa_name, *address, (each->ifa_flags & IFF_LOOPBACK) != 0});
  }
  std::stable_partition(found.begin(), found.end(),
                        [](const auto& each) { return !each.loopback; });
  return found;
}

/// Each name once, as they come.
std::vector<std::string> namesOf(const std::vector<Interface>& all, bool loopback) {
  std::vector<std::string> names;
  for (const Interface& each : all) {
    if (each.loopback == loopback &&
        std::find(names.begin(), names.end(), each.name) == names.end())
      names.push_back(each.name);
  }
  return names;
}

Interface choose(const std::vector<Interface>& all, const std::string& wanted,
                 const std::string& complaint) {
  boost::system::error_code no_address;
  const auto address = asio::ip::make_address(wanted, no_address);
  const auto found = std::find_if(all.begin(), all.end(), [&](const Interface& each) {
    return wanted.empty() || each.name == wanted || (!no_address && each.address == address);
  });
  if (found == all.end()) {
    std::vector<std::string> names = namesOf(all, false);
    for (std::string& each : namesOf(all, true)) names.push_back(std::move(each));
    throw AddressError(complaint + (wanted.empty() ? "this machine has no network for it"
                                                   : "no network here is " + inQuotes(wanted) +
                                                         "; there are " + join(names, ", ")));
  }
  const std::vector<std::string> others = namesOf(all, false);
  if (wanted.empty() && others.size() > 1) {
    spdlog::info("--multicast goes out on {}, the first of {}; @INTERFACE behind it chooses",
                 found->name, join(others, ", "));
  }
  return *found;
}

}  // namespace

MulticastGroup::MulticastGroup(asio::io_context& io, const MulticastChoice& choice, int hops)
    : socket_(io) {
  const std::string complaint = "--multicast " + toString(choice.group) + ": ";
  boost::system::error_code ec;
  const auto group = asio::ip::make_address(choice.group.host, ec);
  if (ec || !group.is_multicast()) {
    throw AddressError(complaint + inQuotes(choice.group.host) +
                       " is no multicast address (224.0.0.0 to 239.255.255.255, or ff00::/8)");
  }
  endpoint_ = {group, choice.group.port};
  const Interface out = choose(interfaces(group.is_v6()), choice.interface, complaint);
  const unsigned index = if_nametoindex(out.name.c_str());
  const auto require = [&](const boost::system::error_code& failed) {
    if (failed) throw std::runtime_error(complaint + failed.message() + " (" + out.name + ")");
  };
  require(socket_.open(endpoint_.protocol(), ec));
  require(socket_.non_blocking(true, ec));
  // From this address, as viewers see it: an IPv6 group belongs to the interface, whatever its
  // address.
  if (group.is_v4()) {
    require(socket_.bind({out.address, 0}, ec));
    require(socket_.set_option(asio::ip::multicast::outbound_interface(out.address.to_v4()), ec));
  } else {
    require(socket_.set_option(asio::ip::multicast::outbound_interface(index), ec));
  }
  require(socket_.set_option(asio::ip::multicast::hops(hops), ec));
  require(socket_.set_option(asio::ip::multicast::enable_loopback(true), ec));
}

}  // namespace hapticast::server
