// SPDX-License-Identifier: MIT
// The UDP half of lossy_link.hpp: every address that sends has a socket of its own towards the
// server, which so sees clients on ports of their own. Thread: the one that runs the io_context.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "common/transport/asio.hpp"
#include "tests/support/link_model.hpp"

namespace hapticast::testing {

class LossyDatagrams {
 public:
  static constexpr std::size_t kMostClients = 256;     ///< then the oldest is forgotten
  static constexpr std::size_t kMostWaiting = 100000;  ///< datagrams; then what comes is lost

  /// The ways outlive it; it outlives the work on `io`. Nothing passes before open().
  LossyDatagrams(asio::io_context& io, LinkWay& up, LinkWay& down);

  /// Relays `listen` to `server`; returns false where the port is not free.
  [[nodiscard]] bool open(const asio::ip::udp::endpoint& listen,
                          const asio::ip::udp::endpoint& server);
  /// While stalled, what comes is lost.
  void stall(bool stalled) { stalled_ = stalled; }
  /// Forgets everybody and what is under way.
  void forget();
  void close();

 private:
  using Bytes = std::shared_ptr<const std::vector<std::uint8_t>>;
  struct Client;
  struct UnderWay {
    std::shared_ptr<Client> client;
    bool up;
    Bytes bytes;
  };
  /// Waits for datagrams, of `client` from the server, of nobody from all clients.
  void listen(const std::shared_ptr<Client>& client);
  void takeAll(const std::shared_ptr<Client>& client);
  std::shared_ptr<Client> clientOf(const asio::ip::udp::endpoint& address);
  void send(const std::shared_ptr<Client>& client, bool up, std::span<const std::uint8_t> bytes);
  /// Delivers what is due and waits for the next.
  void deliver();

  asio::io_context& io_;
  SteadyClock clock_;
  LinkWay& up_;
  LinkWay& down_;
  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint server_;
  asio::steady_timer timer_;
  std::vector<std::uint8_t> buffer_;
  std::map<asio::ip::udp::endpoint, std::shared_ptr<Client>> clients_;
  std::multimap<LocalTime, UnderWay> waiting_;
  std::uint32_t known_ = 0;
  bool stalled_ = false;
};

}  // namespace hapticast::testing
