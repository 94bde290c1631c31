// SPDX-License-Identifier: MIT
// Names under which a browser may ask this server. By DNS rebinding a page of another site can give
// its own name the address of this server, and then read the responses. Its requests have that name
// in their field Host, so the server refuses names that are not its own. An address is safe: a page
// cannot redirect it. Thread: any.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hapticast::server {

/// Returns the names of a server: localhost, `machine` (a host name, possibly with its domain), its
/// first label alone and with .local (its name on the LAN), and `more`.
[[nodiscard]] std::vector<std::string> listHostNames(const std::string& machine,
                                                     const std::vector<std::string>& more);
/// Returns the host name of this machine; an empty text if the system has none.
[[nodiscard]] std::string findMachineName();
/// Returns whether `authority` (HOST or HOST:PORT, as in the field Host; an IPv6 address is in
/// brackets) is an IP address or one of `names`. Capital letters count as small ones.
[[nodiscard]] bool isOwnHost(std::string_view authority, const std::vector<std::string>& names);
/// Returns whether `authority` is localhost or a loopback address, with or without a port.
[[nodiscard]] bool isLoopbackHost(std::string_view authority);

}  // namespace hapticast::server
