// SPDX-License-Identifier: MIT
#include "server/stream/listener.hpp"

#include <fmt/core.h>
#include <spdlog/common.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "common/transport/tcp_channel.hpp"
#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

namespace {
// Chosen: files of the source, the log, the event loop; 11 were measured.
constexpr rlim_t kOwnFiles = 64;
}  // namespace

std::size_t raiseFileLimit(std::size_t viewers, std::size_t pending) {
  const rlim_t beside = kOwnFiles + pending;
  const rlim_t needed = viewers + beside;
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= needed) return viewers;
  limit.rlim_cur = std::min(needed, limit.rlim_max);
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_cur >= needed) return viewers;
  if (limit.rlim_cur <= beside) {
    spdlog::warn(
        "this system allows {} open files, fewer than the server itself may need ({}): the server "
        "accepts one viewer (ulimit -Hn {} allows {})",
        limit.rlim_cur, beside, needed, viewers);
    return 1;
  }
  const rlim_t fit = limit.rlim_cur - beside;
  spdlog::warn(
      "--max-clients {}: this system allows {} open files, enough for {} viewers; the server "
      "rejects more (ulimit -Hn {} allows all)",
      viewers, limit.rlim_cur, fit, needed);
  return fit;
}

namespace {

constexpr auto kPauseAfterError = std::chrono::milliseconds(200);

std::string advice(const boost::system::error_code& ec, std::string_view flag) {
  if (ec == asio::error::address_in_use) {
    return fmt::format("the port is in use; stop the other server or choose another port with {}",
                       flag);
  }
  if (ec == asio::error::access_denied) {
    return fmt::format("ports below 1024 need rights; choose another port with {}", flag);
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

Listener::Listener(asio::io_context& io, const Endpoint& address, Broadcaster& broadcaster,
                   std::optional<TlsContext> tls)
    : acceptor_(openPort(io, address, "--listen")),
      pause_(io),
      broadcaster_(broadcaster),
      address_(describeAddress(acceptor_, address)),
      tls_(std::move(tls)) {}

void Listener::start() {
  asio::co_spawn(
      acceptor_.get_executor(), [this] { return acceptAll(); }, asio::detached);
}

void Listener::setTls(TlsContext tls) {
  asio::post(acceptor_.get_executor(), [this, tls = std::move(tls)] { tls_ = tls; });
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
      accept(std::move(socket));
    } else if (acceptor_.is_open()) {
      // For example out of file handles: an immediate retry would spin.
      broadcaster_.log(spdlog::level::warn, "cannot accept a connection: " + ec.message());
      pause_.expires_after(kPauseAfterError);
      co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    }
  }
}

void Listener::accept(asio::ip::tcp::socket socket) {
  boost::system::error_code ignored;  // without it a stalled viewer only buffers more
  socket.set_option(asio::socket_base::send_buffer_size(broadcaster_.settings().send_buffer_bytes),
                    ignored);
  auto tls = tls_ ? std::make_unique<TlsEngine>(*tls_) : nullptr;
  broadcaster_.accept(std::make_unique<TcpChannel>(std::move(socket), kMaxSmallMessageBytes,
                                                   std::move(tls), ChannelEnd::kServer));
}

}  // namespace hapticast::server
