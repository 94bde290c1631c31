// SPDX-License-Identifier: MIT
// TCP ports on which a program waits for connections. Thread: see each function.
#pragma once

#include <stdexcept>
#include <string_view>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"

namespace hapticast {

/// Error: an address on the command line is invalid or does not belong to this machine. The user
/// can correct it, unlike other failures to open a port. The message is one line that begins with
/// the flag. Thread: any.
class AddressError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Opens a TCP port at `address` and returns its acceptor. Connections wait until the caller
/// accepts them. The host is numeric or localhost (127.0.0.1). [::] means all addresses of IPv6 and
/// IPv4, or those of IPv4 where IPv6 is switched off. Port 0 selects a free port. Throws
/// AddressError or std::runtime_error. Their messages have one line with the address and the
/// remedy, which names `flag`. Thread: main.
asio::ip::tcp::acceptor openPort(asio::io_context& io, const Endpoint& address,
                                 std::string_view flag);

/// Returns the address of `acceptor` for the log: the host of `requested` where it names one
/// address, and the actual port.
[[nodiscard]] Endpoint describeAddress(const asio::ip::tcp::acceptor& acceptor,
                                       const Endpoint& requested);

}  // namespace hapticast
