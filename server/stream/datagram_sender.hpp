// SPDX-License-Identifier: MIT
// The stream by UDP: takes viewers' echoes, and sends every frame's datagrams to all who want them
// and to the group. It sends nothing to an address that has not echoed its viewer's token from the
// host of that viewer's TCP connection. Thread: io, except where a function says "any".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/transport/channel.hpp"
#include "server/stream/datagram_signer.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/stream/udp_fanout.hpp"
#include "server/stream/udp_subscribers.hpp"

namespace hapticast::server {

/// Since the start.
struct DatagramSenderCounts {
  DatagramCounts viewers;
  DatagramCounts group;
  std::array<std::uint64_t, kEchoVerdicts> echoes{};  ///< by AddressValidation

  [[nodiscard]] std::uint64_t of(AddressValidation verdict) const {
    return echoes[static_cast<std::size_t>(verdict)];
  }
  [[nodiscard]] std::uint64_t lost() const {
    return viewers.dropped + viewers.failed + group.dropped + group.failed;
  }
  /// Who has just left, or echoes too often, is no stranger.
  [[nodiscard]] std::uint64_t notBelieved() const {
    return of(AddressValidation::kMalformed) + of(AddressValidation::kForeign) +
           of(AddressValidation::kUnknownToken);
  }
};

class DatagramSender {
 public:
  /// Echoes read before others on the thread have their turn; chosen.
  static constexpr std::size_t kMostEchoes = 64;
  /// Chosen: nobody asks a group for a probe; who joins knows within a second whether datagrams of
  /// full size get through.
  static constexpr Duration kGroupProbeEvery = std::chrono::milliseconds(500);

  /// Takes the UDP port of the listener's number, or another one where that is taken. Signer,
  /// group, if any, and clock outlive it; `io` is run by one thread, which ends before this does.
  /// Throws std::runtime_error with one line.
  DatagramSender(asio::io_context& io, const Clock& clock, const asio::ip::tcp::endpoint& listener,
                 const DatagramSigner& signer, MulticastGroup* group = nullptr);

  /// Takes a viewer in and writes into its welcome what it is told of datagrams; nothing where its
  /// connection has no hosts. The token names the viewer from now on.
  void offer(const Hosts& hosts, Welcome& welcome);
  void left(std::uint64_t token);
  void deliver(std::uint64_t token, const Delivery& delivery);
  void send(const EncodedFrame& frame);
  /// Forgets whose echoes have ceased; called regularly.
  void check(LocalTime now);
  /// Ends it: the port is free again.
  void stop();

  /// Whether making datagrams is worth it. Thread: any.
  [[nodiscard]] bool wanted() const { return wanted_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] DatagramSenderCounts counts() const;

 private:
  asio::awaitable<void> readEchoes();
  void onEcho(std::span<const std::uint8_t> bytes, const asio::ip::udp::endpoint& from);
  void countTakers();
  void sendToGroup();

  asio::ip::udp::socket socket_;
  const Clock& clock_;
  const DatagramSigner& signer_;
  MulticastGroup* group_;
  std::uint64_t group_token_ = 0;
  std::optional<LocalTime> group_probed_at_;
  std::uint16_t port_ = 0;  // its own
  std::uint16_t listener_port_;
  UdpSubscribers book_;
  UdpFanout out_;
  std::unique_ptr<UdpFanout> group_out_;
  std::deque<SignedDatagrams> last_;  // of the frames before, newest first
  DatagramSenderCounts counts_;       // of viewers: of those who left
  std::shared_ptr<DatagramCounts> group_counts_ = std::make_shared<DatagramCounts>();
  std::atomic<bool> wanted_{false};
};

}  // namespace hapticast::server
