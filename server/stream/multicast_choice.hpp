// SPDX-License-Identifier: MIT
// The multicast group of the command line, without sockets. Thread: any.
#pragma once

#include <string>

#include "common/endpoint.hpp"

namespace hapticast::server {

/// A requested multicast group: GROUP:PORT[@INTERFACE].
struct MulticastChoice {
  Endpoint group;
  std::string interface;  ///< name or address; empty: the first suitable one

  bool operator==(const MulticastChoice&) const = default;
};

}  // namespace hapticast::server
