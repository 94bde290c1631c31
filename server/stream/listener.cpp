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

/// Raises this process's limit of open files to `needed`, or as far as the system allows. Returns
/// the limit. A system that does not state it counts as one without a limit.
rlim_t raiseLimitTo(rlim_t needed) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return RLIM_INFINITY;
  if (limit.rlim_cur >= needed) return limit.rlim_cur;
  limit.rlim_cur = std::min(needed, limit.rlim_max);
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) getrlimit(RLIMIT_NOFILE, &limit);
  return limit.rlim_cur;
}
}  // namespace

std::size_t raiseFileLimit(std::size_t viewers, std::size_t pending) {
  const rlim_t beside = kOwnFiles + pending;
  const rlim_t needed = viewers + beside;
  const rlim_t allowed = raiseLimitTo(needed);
  if (allowed >= needed) return viewers;
  if (allowed <= beside) {
    spdlog::warn(
        "this system allows {} open files, fewer than the server itself may need ({}): the server "
        "accepts one viewer (ulimit -Hn {} allows {})",
        allowed, beside, needed, viewers);
    return 1;
  }
  const rlim_t fit = allowed - beside;
  spdlog::warn(
      "--max-clients {}: this system allows {} open files, enough for {} viewers; the server "
      "rejects more (ulimit -Hn {} allows all)",
      viewers, allowed, fit, needed);
  return fit;
}

std::size_t raiseSpareFiles(std::size_t wanted, std::size_t used) {
  const rlim_t beside = kOwnFiles + used;
  const rlim_t allowed = raiseLimitTo(beside + wanted);
  return allowed > beside ? std::min<rlim_t>(wanted, allowed - beside) : 0;
}

namespace {
constexpr auto kPauseAfterError = std::chrono::milliseconds(200);
}  // namespace

Listener::Listener(asio::io_context& io, const Endpoint& address, Broadcaster& broadcaster,
                   std::optional<TlsContext> tls, HttpResponder* responder)
    : acceptor_(openPort(io, address, "--listen")),
      pause_(io),
      broadcaster_(broadcaster),
      address_(describeAddress(acceptor_, address)),
      tls_(std::move(tls)),
      responder_(responder) {}

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
  using UnsentBytes = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_NOTSENT_LOWAT>;
  socket.set_option(UnsentBytes(broadcaster_.settings().unsent_bytes), ignored);
  auto tls = tls_ ? std::make_unique<TlsEngine>(*tls_) : nullptr;
  broadcaster_.accept(std::make_unique<TcpChannel>(
      std::move(socket), kMaxSmallMessageBytes, std::move(tls), ChannelEnd::kServer, responder_));
}

}  // namespace hapticast::server
