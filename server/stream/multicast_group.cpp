// SPDX-License-Identifier: MIT
#include "server/stream/multicast_group.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/text.hpp"
#include "common/transport/network_interfaces.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

namespace {

using Interfaces = std::vector<NetworkInterface>;

/// Returns the interfaces of this IP version.
Interfaces interfaces(bool v6) {
  Interfaces all = networkInterfaces();
  std::erase_if(all, [v6](const auto& each) { return each.address.is_v6() != v6; });
  return all;
}

/// Returns each interface name once, in order.
std::vector<std::string> listNames(const Interfaces& all, bool loopback) {
  std::vector<std::string> names;
  for (const NetworkInterface& each : all) {
    if (each.loopback == loopback &&
        std::find(names.begin(), names.end(), each.name) == names.end())
      names.push_back(each.name);
  }
  return names;
}

NetworkInterface choose(const Interfaces& all, const std::string& wanted,
                        const std::string& complaint) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const NetworkInterface& each) {
    return wanted.empty() || each.hasName(wanted);
  });
  if (found == all.end()) {
    std::vector<std::string> names = listNames(all, false);
    for (std::string& each : listNames(all, true)) names.push_back(std::move(each));
    throw AddressError(complaint + (wanted.empty()
                                        ? "this machine has no network for it"
                                        : "this machine has no network " + quote(wanted) +
                                              "; its networks are " + join(names, ", ")));
  }
  const std::vector<std::string> others = listNames(all, false);
  if (wanted.empty() && others.size() > 1) {
    spdlog::info("--multicast sends on {}, the first of {}; append @INTERFACE to choose another",
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
    throw AddressError(complaint + quote(choice.group.host) +
                       " is not a multicast address (224.0.0.0 to 239.255.255.255, or ff00::/8)");
  }
  endpoint_ = {group, choice.group.port};
  const NetworkInterface out = choose(interfaces(group.is_v6()), choice.interface, complaint);
  const auto require = [&](const boost::system::error_code& failed) {
    if (failed) throw std::runtime_error(complaint + failed.message() + " (" + out.name + ")");
  };
  require(socket_.open(endpoint_.protocol(), ec));
  require(socket_.non_blocking(true, ec));
  // Binds an IPv4 socket to this address, which viewers see as the source. An IPv6 group belongs to
  // the interface, whatever its address.
  if (group.is_v4()) {
    require(socket_.bind({out.address, 0}, ec));
    require(socket_.set_option(asio::ip::multicast::outbound_interface(out.address.to_v4()), ec));
  } else {
    require(socket_.set_option(asio::ip::multicast::outbound_interface(out.index), ec));
  }
  require(socket_.set_option(asio::ip::multicast::hops(hops), ec));
  require(socket_.set_option(asio::ip::multicast::enable_loopback(true), ec));
}

}  // namespace hapticast::server
