// SPDX-License-Identifier: MIT
#include "common/transport/tcp_port.hpp"

#include <string>

namespace hapticast {

namespace {

std::string advice(const boost::system::error_code& ec, std::string_view flag) {
  if (ec == asio::error::address_in_use) {
    return "the port is in use; stop the other server or choose another port with " +
           std::string(flag);
  }
  if (ec == asio::error::access_denied) {
    return "ports below 1024 need rights; choose another port with " + std::string(flag);
  }
  if (ec == boost::system::errc::address_not_available) {
    return "this machine has no such address; [::] means all its addresses";
  }
  return ec.message();
}

}  // namespace

asio::ip::tcp::acceptor openPort(asio::io_context& io, const Endpoint& address,
                                 std::string_view flag) {
  const std::string complaint = "cannot listen on " + toString(address) + ": ";
  boost::system::error_code ec;
  auto ip = asio::ip::make_address(address.host == "localhost" ? "127.0.0.1" : address.host, ec);
  if (ec) {
    throw AddressError(std::string(flag) + ": " + complaint + "'" + address.host +
                       "' is not an IP address of this machine ([::] means all)");
  }
  const auto require = [&](const boost::system::error_code& failed) {
    if (failed) throw std::runtime_error(complaint + advice(failed, flag));
  };
  asio::ip::tcp::acceptor acceptor(io);
  const bool all = ip == asio::ip::address_v6::any();
  acceptor.open(all ? asio::ip::tcp::v6() : asio::ip::tcp::endpoint(ip, 0).protocol(), ec);
  if (all && ec == asio::error::address_family_not_supported) {  // IPv6 is switched off
    ip = asio::ip::address_v4::any();
    acceptor.open(asio::ip::tcp::v4(), ec);
  }
  require(ec);
  if (ip == asio::ip::address_v6::any()) acceptor.set_option(asio::ip::v6_only(false), ec);
  require(acceptor.set_option(asio::socket_base::reuse_address(true), ec));
  require(acceptor.bind({ip, address.port}, ec));
  require(acceptor.listen(asio::socket_base::max_listen_connections, ec));
  return acceptor;
}

Endpoint describeAddress(const asio::ip::tcp::acceptor& acceptor, const Endpoint& requested) {
  const auto actual = acceptor.local_endpoint();
  const bool all = actual.address().is_unspecified();
  return {all ? actual.address().to_string() : requested.host, actual.port()};
}

}  // namespace hapticast
