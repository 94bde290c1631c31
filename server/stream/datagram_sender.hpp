// SPDX-License-Identifier: MIT
// UDP delivery: receives viewers' echoes (return routability, as in QUIC's address validation) and
// sends every frame's datagrams to subscribed viewers and to the multicast group.
// It sends to no address that has not echoed its viewer's token from the host of that viewer's TCP
// connection. Thread: io, except where a function says "any".
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "common/protocol/messages.hpp"
#include "common/transport/channel.hpp"
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/stream/udp_fanout.hpp"
#include "server/stream/udp_subscribers.hpp"

namespace hapticast::server {

// Signs a frame's datagrams (Ed25519), once for all receivers. Thread: the encoder's for sign();
// any for the constant members.

/// Key and stream number of one run of the server.
class DatagramSigner {
 public:
  /// Creates a random key and stream number, which are not predictable.
  DatagramSigner();

  /// Returns the signed datagrams without tokens; null if the frame is too large for datagrams.
  [[nodiscard]] SignedDatagrams sign(const CodedFrame& frame);

  [[nodiscard]] std::uint32_t stream() const { return stream_; }
  [[nodiscard]] const KeyBytes& verifyingKey() const { return key_.verifyingKey(); }
  [[nodiscard]] const std::vector<std::uint8_t>& probe() const { return probe_; }

 private:
  SigningKey key_;
  std::uint32_t stream_;
  std::vector<std::uint8_t> probe_;
};

/// Counts since the start.
struct DatagramSenderCounts {
  DatagramCounts viewers;                             ///< datagrams to viewers
  DatagramCounts group;                               ///< datagrams to the group
  std::array<std::uint64_t, kEchoVerdicts> echoes{};  ///< by AddressValidation

  [[nodiscard]] std::uint64_t of(AddressValidation verdict) const {
    return echoes[static_cast<std::size_t>(verdict)];
  }
  /// Returns the datagrams that were not sent.
  [[nodiscard]] std::uint64_t lost() const {
    return viewers.dropped + viewers.failed + group.dropped + group.failed;
  }
  /// Returns the rejected echoes that no present viewer sent. Echoes of former viewers and too
  /// frequent echoes do not count.
  [[nodiscard]] std::uint64_t notBelieved() const {
    return of(AddressValidation::kMalformed) + of(AddressValidation::kForeign) +
           of(AddressValidation::kUnknownToken);
  }
};

/// Sender of one stream.
class DatagramSender {
 public:
  /// Limit of echoes read before other work on the thread; chosen.
  static constexpr std::size_t kMostEchoes = 64;
  /// Interval of probes to the group. Chosen: a new member detects within a second whether
  /// datagrams of full size arrive.
  static constexpr Duration kGroupProbeEvery = std::chrono::milliseconds(500);

  /// Binds the UDP port with the listener's number, or another one if that is in use. `signer`,
  /// `group` (may be null) and `clock` must outlive the sender.
  /// One thread runs `io` and ends before the sender's destruction. Throws std::runtime_error with
  /// one line.
  DatagramSender(asio::io_context& io, const Clock& clock, const asio::ip::tcp::endpoint& listener,
                 const DatagramSigner& signer, MulticastGroup* group = nullptr);

  /// Adds a viewer and writes its datagram parameters to `welcome`. The token identifies the viewer
  /// from then on. Does nothing if `hosts` is unspecified.
  void offer(const Hosts& hosts, Welcome& welcome);
  /// Removes a viewer.
  void left(std::uint64_t token);
  /// Sets how the viewer wants its frames.
  void deliver(std::uint64_t token, const Delivery& delivery);
  /// Sends the frame's datagrams, with the redundancy of each viewer, to all subscribers and the
  /// group.
  void send(const EncodedFrame& frame);
  /// Removes the addresses whose echoes have ceased. Call about once a second.
  void check(LocalTime now);
  /// Stops sending and frees the port.
  void stop();

  /// Returns whether a viewer or the group needs datagrams. Thread: any.
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
  std::uint16_t port_ = 0;  // the sender's own
  std::uint16_t listener_port_;
  UdpSubscribers book_;
  UdpFanout out_;
  std::unique_ptr<UdpFanout> group_out_;
  std::deque<SignedDatagrams> last_;  // earlier frames, newest first
  DatagramSenderCounts counts_;       // viewers: of viewers that left
  std::shared_ptr<DatagramCounts> group_counts_ = std::make_shared<DatagramCounts>();
  std::atomic<bool> wanted_{false};
};

}  // namespace hapticast::server
