// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "common/endpoint.hpp"

namespace hapticast::server {

/// A multicast group as it is asked for: GROUP:PORT[@INTERFACE].
struct MulticastChoice {
  Endpoint group;
  std::string interface;  ///< a name or an address; empty: whichever there is

  bool operator==(const MulticastChoice&) const = default;
};

}  // namespace hapticast::server
