// SPDX-License-Identifier: MIT
#include "tests/support/lossy_datagrams.hpp"

#include <algorithm>

namespace hapticast::testing {

namespace {
using asio::ip::udp;
constexpr int kBufferBytes = 4 << 20;  // of a socket: bursts of many viewers; the system may cut it
constexpr int kMostAtOnce = 64;        // then others have their turn

void makeReady(udp::socket& socket) {
  boost::system::error_code ignored;  // it only loses more
  socket.set_option(asio::socket_base::receive_buffer_size(kBufferBytes), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kBufferBytes), ignored);
  socket.non_blocking(true);
}
}  // namespace

struct LossyDatagrams::Client {
  Client(asio::io_context& io, const udp::endpoint& its_address, const udp::endpoint& server,
         LinkWay& up_way, LinkWay& down_way, std::uint32_t number)
      : address(its_address),
        socket(io, server.protocol()),
        up(up_way, 4 * number + 2),
        down(down_way, 4 * number + 3),
        since(number) {
    socket.connect(server);
    makeReady(socket);
  }
  udp::endpoint address;
  udp::socket socket;  // towards the server
  LinkModel up;
  LinkModel down;
  std::uint32_t since;
};

LossyDatagrams::LossyDatagrams(asio::io_context& io, LinkWay& up, LinkWay& down)
    : io_(io), up_(up), down_(down), socket_(io), timer_(io), buffer_(1U << 16U) {}

bool LossyDatagrams::open(const udp::endpoint& listen_at, const udp::endpoint& server) {
  server_ = server;
  boost::system::error_code ec;
  socket_ = udp::socket(io_, listen_at.protocol());
  socket_.bind(listen_at, ec);
  if (ec) return false;
  makeReady(socket_);
  listen(nullptr);
  return true;
}

void LossyDatagrams::forget() {
  for (const auto& each : clients_) each.second->socket.close();
  clients_.clear();
  waiting_.clear();
}

void LossyDatagrams::close() {
  boost::system::error_code ignored;
  socket_.close(ignored);
  forget();
  timer_.cancel();
}

void LossyDatagrams::listen(const std::shared_ptr<Client>& client) {
  (client ? client->socket : socket_)
      .async_wait(udp::socket::wait_read, [this, client](const boost::system::error_code& ec) {
        if (ec) return;  // closed
        takeAll(client);
        if ((client ? client->socket : socket_).is_open()) listen(client);
      });
}

void LossyDatagrams::takeAll(const std::shared_ptr<Client>& client) {
  for (int i = 0; i < kMostAtOnce; ++i) {
    boost::system::error_code ec;
    udp::endpoint from;
    const std::size_t size =
        (client ? client->socket : socket_).receive_from(asio::buffer(buffer_), from, 0, ec);
    if (ec == asio::error::connection_refused) continue;  // an earlier one found nobody there
    if (ec) break;
    if (stalled_) {
      ++(client ? down_ : up_).counts.stalled;
    } else {
      send(client ? client : clientOf(from), !client, std::span(buffer_).first(size));
    }
  }
  deliver();
}

std::shared_ptr<LossyDatagrams::Client> LossyDatagrams::clientOf(const udp::endpoint& address) {
  auto& client = clients_[address];
  if (client) return client;
  client = std::make_shared<Client>(io_, address, server_, up_, down_, known_++);
  listen(client);
  auto taken = client;
  if (clients_.size() > kMostClients) {
    const auto oldest = std::min_element(
        clients_.begin(), clients_.end(),
        [](const auto& a, const auto& b) { return a.second->since < b.second->since; });
    oldest->second->socket.close();
    clients_.erase(oldest);
  }
  return taken;
}

void LossyDatagrams::send(const std::shared_ptr<Client>& client, bool up,
                          std::span<const std::uint8_t> bytes) {
  if (waiting_.size() >= kMostWaiting) return;
  const auto arrivals = (up ? client->up : client->down).datagram(clock_.now(), bytes.size());
  if (arrivals.count == 0) return;
  const auto copy = std::make_shared<const std::vector<std::uint8_t>>(bytes.begin(), bytes.end());
  for (std::size_t i = 0; i < arrivals.count; ++i) {
    waiting_.emplace(arrivals.at[i], UnderWay{client, up, copy});
  }
}

void LossyDatagrams::deliver() {
  const LocalTime now = clock_.now();
  while (!waiting_.empty() && waiting_.begin()->first <= now) {
    const UnderWay due = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    boost::system::error_code ignored;  // nobody there, or a full buffer: lost
    if (due.up) {
      due.client->socket.send(asio::buffer(*due.bytes), 0, ignored);
    } else {
      socket_.send_to(asio::buffer(*due.bytes), due.client->address, 0, ignored);
    }
  }
  if (waiting_.empty()) return;
  timer_.expires_after(waiting_.begin()->first - now);
  timer_.async_wait([this](const boost::system::error_code& ec) {
    if (!ec) deliver();
  });
}

}  // namespace hapticast::testing
