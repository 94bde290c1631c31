// SPDX-License-Identifier: MIT
// The networks of this machine, for multicast. Thread: any.
#pragma once

#include <string>
#include <vector>

#include "common/transport/asio.hpp"

namespace hapticast {

/// An address of one of this machine's networks; one with several addresses comes several times.
struct NetworkInterface {
  std::string name;
  unsigned index = 0;
  asio::ip::address address;
  bool loopback = false;

  /// Whether this is what a person calls it: by its name or its address.
  [[nodiscard]] bool called(const std::string& text) const;
};

/// Those that are up; the loopback comes last.
[[nodiscard]] std::vector<NetworkInterface> networkInterfaces();

}  // namespace hapticast
