// SPDX-License-Identifier: MIT
// Network interfaces of this machine, for multicast. Thread: any.
#pragma once

#include <string>
#include <vector>

#include "common/transport/asio.hpp"

namespace hapticast {

/// One address of a network interface; an interface with several addresses has several entries.
struct NetworkInterface {
  std::string name;
  unsigned index = 0;
  asio::ip::address address;
  bool loopback = false;

  /// Returns true if `text` is the interface's name or this address.
  [[nodiscard]] bool hasName(const std::string& text) const;
};

/// Returns the addresses of all interfaces that are up. The addresses of the loopback interface are
/// last.
[[nodiscard]] std::vector<NetworkInterface> networkInterfaces();

}  // namespace hapticast
