// SPDX-License-Identifier: MIT
// The link to the page, for the log. Thread: any.
#pragma once

#include <span>
#include <string>

#include "common/transport/network_interfaces.hpp"

namespace hapticast::server {

/// Returns the link to the page of a server that listens at `endpoint`, such as
/// http://192.0.2.7:7447/. If it listens at all addresses, the link has one of `interfaces` that
/// other machines can reach, or localhost if there is none. `tls`: the link begins with https.
[[nodiscard]] std::string makePageLink(const asio::ip::tcp::endpoint& endpoint, bool tls,
                                       std::span<const NetworkInterface> interfaces);

}  // namespace hapticast::server
