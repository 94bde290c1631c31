// SPDX-License-Identifier: MIT
// Address validation of UDP subscribers: stores to which address each viewer's datagrams are sent.
// A viewer sets its address by an echo: a datagram with the token from its welcome. An echo counts
// only from the host of the viewer's TCP connection, so that no attacker can direct the stream at
// another host. It has no sockets and no clocks. Thread: the network's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>

#include "common/protocol/messages.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/udp_fanout.hpp"

namespace hapticast::server {

/// Result of the validation of an echo (a datagram by which a viewer sends back the token from its
/// welcome). The checks run in this order; the first that fails is the result.
enum class AddressValidation : std::uint8_t {
  kValidated,     ///< valid; the server answers with a probe (datagram of full size)
  kMalformed,     ///< the datagram does not have the 12 bytes of an echo
  kOtherStream,   ///< the echo belongs to another run of the server
  kUnknownToken,  ///< no viewer has this token at present
  kForeign,       ///< the sender is not the host of the viewer's TCP connection
  kTooSoon,       ///< the viewer's last echo was less than kLeastPause ago
};
inline constexpr std::size_t kEchoVerdicts = 6;

/// Table of all viewers that may receive datagrams, by token.
class UdpSubscribers {
 public:
  /// How long an address remains valid after an echo. The value is a choice: a viewer sends an echo
  /// every 10 s, and two of three echoes may be lost.
  static constexpr Duration kForgetAfter = std::chrono::seconds(30);
  /// Least time between two valid echoes of a viewer. The value is a choice: half of the time that
  /// a viewer waits for a probe after its echo. A probe is a hundred times as large as its echo. So
  /// the pause limits amplification by forged echoes.
  static constexpr Duration kLeastPause = std::chrono::milliseconds(100);

  /// A viewer, and the address to which its datagrams are sent.
  struct Viewer {
    asio::ip::address peer;   ///< remote address of its TCP connection
    asio::ip::address local;  ///< local address of its TCP connection; source of its datagrams
    bool wanted = true;       ///< it requested datagrams, which it receives after its echo
    std::uint32_t copies = 1;
    /// Whether it receives the multicast group's datagrams.
    bool by_group = false;
    std::optional<asio::ip::udp::endpoint> at;  ///< address that an echo has validated
    LocalTime received{};                       ///< time of the last valid echo
    std::shared_ptr<DatagramCounts> counts = std::make_shared<DatagramCounts>();
  };

  explicit UdpSubscribers(std::uint32_t stream) : stream_(stream) {}

  /// Adds a viewer whose TCP connection has the addresses `peer` (its own) and `local` (this
  /// machine's). Returns its token, which is not predictable.
  std::uint64_t add(const asio::ip::address& peer, const asio::ip::address& local);
  /// Removes the viewer with this token. Returns the counts of its datagrams.
  DatagramCounts remove(std::uint64_t token);
  /// Removes all viewers. Echoes are valid for the stream number `stream` from now on. Returns the
  /// counts of the viewers' datagrams.
  DatagramCounts restart(std::uint32_t stream);
  /// Sets transport and redundancy of the viewer with this token, from now on.
  void setDelivery(std::uint64_t token, const Delivery& delivery);
  /// Checks an echo `bytes` that arrived from `from`, and returns the result. A valid echo makes
  /// `from` the viewer's address.
  AddressValidation onEcho(std::span<const std::uint8_t> bytes, const asio::ip::udp::endpoint& from,
                           LocalTime now);
  /// Removes the addresses of viewers whose last echo is kForgetAfter or longer ago.
  void forget(LocalTime now);

  /// Returns the viewer with this token; null if there is none.
  [[nodiscard]] Viewer* find(std::uint64_t token);
  /// Calls `visit`(token, viewer) for all viewers that receive datagrams.
  template <class Visit>
  void forEachSubscriber(Visit&& visit) {
    for (auto& [token, viewer] : viewers_) {
      if (viewer.at && viewer.wanted) visit(token, viewer);
    }
  }
  /// Returns whether any viewer receives datagrams.
  [[nodiscard]] bool hasSubscribers() const;
  [[nodiscard]] DatagramCounts counts() const;
  [[nodiscard]] std::size_t size() const { return viewers_.size(); }
  /// Returns the redundancy for the multicast group. It is the redundancy that suffices for at
  /// least nine of ten viewers in the group. It is 1 if the group has no viewers.
  [[nodiscard]] std::uint32_t groupCopies() const;

 private:
  std::uint32_t stream_;
  std::unordered_map<std::uint64_t, Viewer> viewers_;
};

}  // namespace hapticast::server
