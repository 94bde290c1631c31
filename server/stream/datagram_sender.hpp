// SPDX-License-Identifier: MIT
// UDP delivery: sends the datagrams of every frame to the subscribed viewers and to the multicast
// group. A viewer subscribes by an echo: a datagram with the token from its welcome. The echo
// proves that the viewer receives at its address (return routability, as in QUIC's address
// validation). Echoes count only from the host of the viewer's TCP connection. No other address
// receives datagrams. Thread: the network's, except for functions with "Thread: any".
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
#include "common/transport/datagram.hpp"
#include "server/stream/encoded.hpp"
#include "server/stream/multicast_group.hpp"
#include "server/stream/stream_identity.hpp"
#include "server/stream/udp_fanout.hpp"
#include "server/stream/udp_subscribers.hpp"

namespace hapticast::server {

/// Counts of datagrams and echoes since the sender's creation.
struct DatagramSenderCounts {
  DatagramCounts viewers;                             ///< datagrams to viewers
  DatagramCounts group;                               ///< datagrams to the multicast group
  std::array<std::uint64_t, kEchoVerdicts> echoes{};  ///< number of echoes by their result

  [[nodiscard]] std::uint64_t of(AddressValidation verdict) const {
    return echoes[static_cast<std::size_t>(verdict)];
  }
  /// Returns the number of datagrams that were not sent.
  [[nodiscard]] std::uint64_t lost() const {
    return viewers.dropped + viewers.failed + group.dropped + group.failed;
  }
  /// Returns the number of echoes that are malformed, have an unknown token or come from another
  /// host than the viewer's. Echoes to an earlier run of the server and too frequent echoes do not
  /// count.
  [[nodiscard]] std::uint64_t rejectedEchoes() const {
    return of(AddressValidation::kMalformed) + of(AddressValidation::kForeign) +
           of(AddressValidation::kUnknownToken);
  }
};

/// Sends the datagrams of one stream and receives the viewers' echoes.
class DatagramSender {
 public:
  /// Largest number of echoes that are read before other work of the thread runs. The value is a
  /// choice.
  static constexpr std::size_t kMostEchoes = 64;
  /// Interval of probes to the multicast group. A probe is a datagram of full size without content.
  /// The value is a choice: a new member detects within a second whether such datagrams arrive.
  static constexpr Duration kGroupProbeEvery = std::chrono::milliseconds(500);

  /// Opens the UDP port with the same number as the TCP port `listener`, or a free port if that one
  /// is in use. Throws std::runtime_error with a message of one line. `identity`: the server that
  /// signs the datagrams. `group` (may be null) and `clock` must outlive the sender. One thread
  /// runs `io`; it must end before the sender's destruction.
  DatagramSender(asio::io_context& io, const Clock& clock, const asio::ip::tcp::endpoint& listener,
                 const StreamIdentity& identity, MulticastGroup* group = nullptr);

  /// Adds a viewer and writes its token and the other parameters for datagrams into `welcome`. The
  /// token identifies the viewer in later calls. Does nothing if an address in `hosts` is
  /// unspecified.
  void offer(const Hosts& hosts, Welcome& welcome);
  /// Changes to another origin, which signs the datagrams from now on. Removes all viewers, so that
  /// their tokens are no longer valid, and all waiting datagrams. Call offer() again for each
  /// viewer.
  void changeOrigin(const StreamIdentity& identity);
  /// Removes the viewer with this token.
  void removeViewer(std::uint64_t token);
  /// Sets whether the viewer with this token receives datagrams, and with which redundancy.
  void setDelivery(std::uint64_t token, const Delivery& delivery);
  /// Sends the frame's datagrams to all subscribers and to the multicast group. A viewer with a
  /// redundancy above 1 also receives the datagrams of earlier frames again.
  void send(const EncodedFrame& frame);
  /// Removes the addresses of viewers whose last echo is too old (UdpSubscribers::forget()). Call
  /// it about once a second.
  void check(LocalTime now);
  /// Ends the sending and closes the port.
  void stop();

  /// Returns whether at least one viewer or the multicast group needs datagrams. Thread: any.
  [[nodiscard]] bool wanted() const { return wanted_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] DatagramSenderCounts counts() const;

 private:
  asio::awaitable<void> readEchoes();
  void onEcho(std::span<const std::uint8_t> bytes, const asio::ip::udp::endpoint& from);
  void updateWanted();
  void sendToGroup();

  asio::ip::udp::socket socket_;
  const Clock& clock_;
  StreamIdentity identity_;
  MulticastGroup* group_;
  std::uint64_t group_token_ = 0;
  std::optional<LocalTime> group_probed_at_;
  std::uint16_t port_ = 0;  // number of the sender's port
  std::uint16_t listener_port_;
  UdpSubscribers subscribers_;
  UdpFanout out_;
  std::unique_ptr<UdpFanout> group_out_;
  std::deque<SignedDatagrams> last_;  // earlier frames, newest first
  DatagramSenderCounts counts_;       // its member `viewers` counts viewers that left
  std::shared_ptr<DatagramCounts> group_counts_ = std::make_shared<DatagramCounts>();
  std::atomic<bool> wanted_{false};
};

}  // namespace hapticast::server
