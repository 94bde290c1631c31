// SPDX-License-Identifier: MIT
// A bad network on this machine for tests: relays TCP connections and UDP datagrams to a server
// through a link_model.hpp each way. TCP keeps its order, a lost packet only holds it up. Thread:
// the one that runs the io_context.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/transport/asio.hpp"
#include "tests/support/link_model.hpp"
#include "tests/support/lossy_datagrams.hpp"

namespace hapticast::testing {

class LossyLink {
 public:
  /// Relays `listen` to `server`, both their TCP and their UDP; port 0 takes one that is free for
  /// both. Throws boost::system::system_error. Outlives the work on `io`.
  LossyLink(asio::io_context& io, const asio::ip::tcp::endpoint& listen,
            const asio::ip::tcp::endpoint& server, const LinkProfile& up, const LinkProfile& down);
  /// From 127.0.0.1 to 127.0.0.1:`target`, the same both ways.
  LossyLink(asio::io_context& io, std::uint16_t target, const LinkProfile& profile);

  [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  /// From the clients to the server; its profile may be changed at any time.
  [[nodiscard]] LinkWay& up() { return up_; }
  [[nodiscard]] LinkWay& down() { return down_; }
  /// While stalled, connections stay open and nothing passes; datagrams are lost.
  void stall(bool stalled);
  /// Resets every connection and forgets who sent datagrams; new ones are accepted.
  void cut();
  /// Accepts nothing any more and cuts.
  void close();

 private:
  struct Relay;   // one connection
  struct Stream;  // one direction of it
  void listen(const asio::ip::tcp::endpoint& at);
  asio::awaitable<void> acceptAll();
  void start(const std::shared_ptr<Relay>& relay);
  asio::awaitable<void> take(std::shared_ptr<Relay> relay, std::shared_ptr<Stream> stream);
  asio::awaitable<void> deliver(std::shared_ptr<Relay> relay, std::shared_ptr<Stream> stream);

  SteadyClock clock_;
  LinkWay up_;
  LinkWay down_;
  asio::ip::tcp::acceptor acceptor_;
  asio::ip::tcp::endpoint server_;
  LossyDatagrams datagrams_;
  bool stalled_ = false;
  std::uint32_t relayed_ = 0;
  std::vector<std::weak_ptr<Relay>> relays_;
};

}  // namespace hapticast::testing
