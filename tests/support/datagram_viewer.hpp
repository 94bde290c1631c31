// SPDX-License-Identifier: MIT
// A viewer's end of the datagrams: echoes, receives, accepts only datagrams that are
// signed, and joins it.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"

namespace hapticast::testing {

class DatagramViewer {
 public:
  /// `from`: its own address; the server is at `to`.
  DatagramViewer(asio::io_context& io, const Welcome& welcome, const asio::ip::udp::endpoint& from,
                 asio::ip::udp::endpoint to)
      : socket_(io, from),
        to_(std::move(to)),
        welcome_(welcome),
        key_(VerifyingKey::from(welcome.verifying_key.value()).value()) {
    socket_.non_blocking(true);
  }
  /// Listens to the welcome's group on the network of `interface`.
  void join(const asio::ip::address& interface) {
    const auto group = asio::ip::make_address(welcome_.group->address);
    if (group.is_v4()) {
      socket_.set_option(asio::ip::multicast::join_group(group.to_v4(), interface.to_v4()));
    } else {
      socket_.set_option(
          asio::ip::multicast::join_group(group.to_v6(), interface.to_v6().scope_id()));
    }
    token_ = welcome_.group->token;
  }
  void echo() { send(echoBytes({welcome_.datagram_token, welcome_.stream})); }
  void echo(std::uint64_t token) { send(echoBytes({token, welcome_.stream})); }
  template <class Bytes>
  void send(const Bytes& bytes) {
    socket_.send_to(asio::buffer(bytes), to_);
  }
  /// Takes what has arrived.
  void poll() {
    std::array<std::uint8_t, 2000> bytes{};
    boost::system::error_code ec;
    for (;;) {
      asio::ip::udp::endpoint from;
      const std::size_t size = socket_.receive_from(asio::buffer(bytes), from, 0, ec);
      if (ec) return;
      froms.push_back(from);
      take(std::span(bytes).first(size));
    }
  }
  [[nodiscard]] asio::ip::udp::endpoint local() const { return socket_.local_endpoint(); }

  std::vector<asio::ip::udp::endpoint> froms;  ///< of every datagram
  std::size_t probes = 0;
  std::size_t refused = 0;                                     ///< not signed, or not understood
  std::map<std::uint64_t, std::map<std::uint16_t, int>> seen;  ///< how often each part came
  std::vector<CodedFrame> frames;                              ///< whole, as they became so

 private:
  void take(std::span<const std::uint8_t> bytes) {
    const auto datagram = readDatagram(bytes);
    if (!datagram || datagram->token != token_ || datagram->header.stream != welcome_.stream ||
        !key_.verify(datagram->signed_bytes, datagram->signature)) {
      ++refused;
      return;
    }
    const DatagramHeader& header = datagram->header;
    if (header.probe()) {
      ++probes;
      return;
    }
    if (++seen[header.frame][header.part] > 1) return;
    Reassembly& joined = joining_.try_emplace(header.frame, header).first->second;
    if (joined.add(header, datagram->payload)) ++refused;
    if (joined.whole()) frames.push_back(joined.frame());
  }

  asio::ip::udp::socket socket_;
  asio::ip::udp::endpoint to_;
  Welcome welcome_;
  VerifyingKey key_;
  std::uint64_t token_ = welcome_.datagram_token;
  std::map<std::uint64_t, Reassembly> joining_;
};

}  // namespace hapticast::testing
