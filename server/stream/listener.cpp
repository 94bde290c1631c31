// SPDX-License-Identifier: MIT
#include "server/stream/listener.hpp"

#include <spdlog/spdlog.h>

#include <charconv>
#include <stdexcept>
#include <utility>

namespace hapticast::server {

namespace {

constexpr auto kPauseAfterError = std::chrono::milliseconds(200);

template <class Failure = AddressError>
[[noreturn]] void fail(const std::string& address, const std::string& why) {
  throw Failure("cannot listen on " + address + ": " + why);
}

asio::ip::tcp::endpoint parse(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) fail(address, "expected ADDR:PORT, such as 0.0.0.0:7447");
  std::string host = address.substr(0, colon);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  }
  boost::system::error_code ec;
  const auto ip = asio::ip::make_address(host, ec);
  if (ec) fail(address, "'" + host + "' is not an IP address of this machine (0.0.0.0 means all)");
  std::uint16_t port = 0;
  const char* const end = address.data() + address.size();
  const auto parsed = std::from_chars(address.data() + colon + 1, end, port);
  if (parsed.ec != std::errc() || parsed.ptr != end) fail(address, "the port is not 0..65535");
  return {ip, port};
}

std::string advice(const boost::system::error_code& ec) {
  if (ec == asio::error::address_in_use) {
    return "the port is in use; stop the other server or choose another port with --listen";
  }
  if (ec == asio::error::access_denied) {
    return "ports below 1024 need rights; choose another port with --listen";
  }
  if (ec == boost::system::errc::address_not_available) {
    return "this machine has no such address; 0.0.0.0 means all it has";
  }
  return ec.message();
}

}  // namespace

Listener::Listener(asio::io_context& io, const std::string& address, Broadcaster& broadcaster)
    : acceptor_(io), pause_(io), broadcaster_(broadcaster) {
  const auto endpoint = parse(address);
  const auto require = [&](const boost::system::error_code& ec) {
    if (ec) fail<std::runtime_error>(address, advice(ec));
  };
  boost::system::error_code ec;
  require(acceptor_.open(endpoint.protocol(), ec));
  require(acceptor_.set_option(asio::socket_base::reuse_address(true), ec));
  require(acceptor_.bind(endpoint, ec));
  require(acceptor_.listen(asio::socket_base::max_listen_connections, ec));
  port_ = acceptor_.local_endpoint().port();
  asio::co_spawn(
      io, [this] { return acceptAll(); }, asio::detached);
}

void Listener::stop() {
  asio::post(acceptor_.get_executor(), [this] {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
  });
}

asio::awaitable<void> Listener::acceptAll() {
  while (acceptor_.is_open()) {
    boost::system::error_code ec;
    auto socket = co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, ec));
    if (!ec) {
      broadcaster_.accept(std::move(socket));
    } else if (acceptor_.is_open()) {
      // Out of file handles, say: trying again at once would spin.
      spdlog::warn("cannot accept a connection: {}", ec.message());
      pause_.expires_after(kPauseAfterError);
      co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    }
  }
}

}  // namespace hapticast::server
