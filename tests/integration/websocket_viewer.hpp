// SPDX-License-Identifier: MIT
// A viewer by WebSocket, with the client of Boost.Beast, which shares no code with the server.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::testing {

/// What a viewer by WebSocket asks for at its begin.
struct WebSocketRequest {
  std::string host{};  ///< HOST:PORT; empty: 127.0.0.1 with the port of the server
  std::string scheme = "http://";
  std::string protocol = "hapticast.3";
  bool deflate = false;
};

/// `Stream`: a socket, or TLS over one.
template <class Stream>
class WebSocketViewer {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// Connects at once. `make`: the arguments of the stream, except a connected socket in front.
  template <class... Make>
  WebSocketViewer(asio::io_context& io, std::uint16_t port, WebSocketRequest request = {},
                  Make&&... make)
      : io_(io), request_(std::move(request)), socket_(connect(io, port), make...) {
    if (request_.host.empty()) request_.host = "127.0.0.1:" + std::to_string(port);
    namespace websocket = boost::beast::websocket;
    websocket::permessage_deflate deflate;
    deflate.client_enable = request_.deflate;
    socket_.set_option(deflate);
    socket_.read_message_max(kMaxMessageBytes);
    socket_.set_option(websocket::stream_base::decorator([this](websocket::request_type& head) {
      head.set("Origin", request_.scheme + request_.host);
      head.set("Sec-WebSocket-Protocol", request_.protocol);
    }));
    socket_.control_callback([this](websocket::frame_type kind, boost::beast::string_view text) {
      if (kind == websocket::frame_type::pong) pongs.emplace_back(text);
    });
    asio::co_spawn(
        io_, [this] { return readAll(); }, asio::detached);
  }

  void send(const Message& message) { sendBytes(encode(message)); }
  void sendBytes(Bytes bytes) {
    waiting_.push_back(std::move(bytes));
    if (waiting_.size() > 1 || !is_open) return;
    asio::co_spawn(
        io_, [this] { return writeAll(); }, asio::detached);
  }
  void ping(const std::string& text) {
    const boost::beast::websocket::ping_data data(
        boost::beast::string_view(text.data(), text.size()));
    boost::system::error_code ended;
    socket_.ping(data, ended);  // at once: Beast permits one asynchronous ping at a time
  }
  void close() {
    socket_.async_close(boost::beast::websocket::close_code::normal,
                        [](const boost::system::error_code&) {});
  }
  /// It reads nothing more until it is called with false.
  void stall(bool stalls) {
    stalls_ = stalls;
    go_on_.cancel();
  }
  template <class T>
  [[nodiscard]] std::vector<T> all() const {
    std::vector<T> found;
    for (const Bytes& each : payloads) {
      auto message = decode(each);
      if (message.ok() && std::holds_alternative<T>(message.value()))
        found.push_back(std::get<T>(std::move(message).value()));
    }
    return found;
  }
  [[nodiscard]] Stream& stream() { return socket_.next_layer(); }

  std::vector<Bytes> payloads;
  std::vector<std::string> pongs;
  bool is_open = false;
  bool ended = false;
  boost::system::error_code error;  ///< of the end
  std::uint16_t close_code = 0;     ///< of the server's close frame; 0: none came
  boost::beast::websocket::response_type response;

 private:
  static asio::ip::tcp::socket connect(asio::io_context& io, std::uint16_t port) {
    asio::ip::tcp::socket socket(io);
    socket.open(asio::ip::tcp::v4());
    socket.set_option(asio::socket_base::receive_buffer_size(16384));  // a stall shows soon
    socket.connect({asio::ip::address_v4::loopback(), port});
    return socket;
  }
  asio::awaitable<void> readAll() {
    auto into = asio::redirect_error(asio::use_awaitable, error);
    if constexpr (!std::is_same_v<Stream, asio::ip::tcp::socket>)
      co_await socket_.next_layer().async_handshake(Stream::client, into);
    if (!error) co_await socket_.async_handshake(response, request_.host, "/stream", into);
    is_open = !error;
    socket_.binary(true);
    if (is_open && !waiting_.empty())
      asio::co_spawn(
          io_, [this] { return writeAll(); }, asio::detached);
    while (!error) {
      while (stalls_) {
        boost::system::error_code cancelled;
        go_on_.expires_at(asio::steady_timer::time_point::max());
        co_await go_on_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
      }
      boost::beast::flat_buffer buffer;
      co_await socket_.async_read(buffer, into);
      if (error) break;
      const auto* const data = static_cast<const std::uint8_t*>(buffer.cdata().data());
      payloads.emplace_back(data, data + buffer.size());
    }
    close_code = socket_.reason().code;
    ended = true;
  }
  asio::awaitable<void> writeAll() {
    boost::system::error_code ec;
    while (!waiting_.empty() && !ec) {
      co_await socket_.async_write(asio::buffer(waiting_.front()),
                                   asio::redirect_error(asio::use_awaitable, ec));
      waiting_.pop_front();
    }
  }

  asio::io_context& io_;
  WebSocketRequest request_;
  boost::beast::websocket::stream<Stream> socket_;
  std::deque<Bytes> waiting_;
  bool stalls_ = false;
  asio::steady_timer go_on_{io_};
};

}  // namespace hapticast::testing
