// SPDX-License-Identifier: MIT
#include "client/device/inverse3/websocket.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <stdexcept>

namespace hapticast::client {

namespace asio = boost::asio;
namespace beast = boost::beast;
using Tcp = asio::ip::tcp;

namespace {
constexpr std::size_t kLongestText = std::size_t{1} << 20U;
// A service on this machine answers within milliseconds; another program there may never answer.
constexpr timeval kReadTimeout{0, 500'000};
}  // namespace

struct WebSocket::Stream {
  asio::io_context io;
  beast::websocket::stream<Tcp::socket> websocket{io};
  // The read of the next message, which continues across calls of receive().
  beast::flat_buffer buffer;
  bool reads = false;
  bool done = false;
  boost::system::error_code error;

  void startRead() {
    if (reads) return;
    reads = true;
    done = false;
    websocket.async_read(buffer, [this](boost::system::error_code result, std::size_t /*size*/) {
      error = result;
      done = true;
    });
  }
  void poll() {
    io.restart();
    (void)io.poll();
  }
};

WebSocket::WebSocket(const std::string& host, const std::string& port)
    : stream_(std::make_unique<Stream>()) {
  auto& websocket = stream_->websocket;
  try {
    Tcp::resolver resolver(stream_->io);
    asio::connect(websocket.next_layer(), resolver.resolve(host, port));
    websocket.next_layer().set_option(Tcp::no_delay(true));
    (void)setsockopt(websocket.next_layer().native_handle(), SOL_SOCKET, SO_RCVTIMEO, &kReadTimeout,
                     sizeof kReadTimeout);
    websocket.read_message_max(kLongestText);
    websocket.handshake(host + ":" + port, "/");
    websocket.text(true);
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error(error.code().message());
  }
}

WebSocket::~WebSocket() = default;

void WebSocket::send(const std::string& text) {
  boost::system::error_code error;
  stream_->websocket.write(asio::buffer(text), error);
  if (error) throw std::runtime_error(error.message());
}

// The stream may hold a message that arrived together with the one before, or with the answer to
// the handshake. So the read comes before the wait for the socket.
std::optional<std::string> WebSocket::receive(LocalTime deadline) {
  Stream& stream = *stream_;
  const SteadyClock clock;
  stream.startRead();
  stream.poll();
  while (!stream.done) {
    const auto left = std::max(deadline - clock.now(), Duration::zero());
    const timespec timeout{static_cast<time_t>(left.count() / 1'000'000'000),
                           static_cast<long>(left.count() % 1'000'000'000)};
    pollfd ready{
        .fd = stream.websocket.next_layer().native_handle(), .events = POLLIN, .revents = 0};
    if (ppoll(&ready, 1, &timeout, nullptr) <= 0) return std::nullopt;
    stream.poll();
  }
  stream.reads = false;
  if (stream.error) throw std::runtime_error(stream.error.message());
  std::string text = beast::buffers_to_string(stream.buffer.data());
  stream.buffer.consume(stream.buffer.size());
  return text;
}

}  // namespace hapticast::client
