// SPDX-License-Identifier: MIT
// Address validation of UDP subscribers: an echo of the viewer's token sets its address (return
// routability).
// An echo counts only from the host of the viewer's TCP connection, so that nobody can direct the
// stream at another host. No sockets, no clocks. Thread: io.
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

/// Result of an echo, in the order of the checks.
enum class AddressValidation : std::uint8_t {
  kBelieved,      ///< valid; the server answers with a probe
  kMalformed,     ///< not 12 bytes
  kOtherStream,   ///< another run of the server
  kUnknownToken,  ///< no viewer has this token now
  kForeign,       ///< not the host of the viewer's TCP connection
  kTooSoon,       ///< too soon after this viewer's last echo
};
inline constexpr std::size_t kEchoVerdicts = 6;

/// Table of all viewers, by token.
class UdpSubscribers {
 public:
  /// Lifetime of an address. Chosen: a viewer echoes every 10 s, and two of three echoes may be
  /// lost.
  static constexpr Duration kForgetAfter = std::chrono::seconds(30);
  /// Least interval of a viewer's echoes. Chosen: half of the time that a viewer waits for a probe.
  /// A probe is a hundred times as large as its echo, so this bounds the amplification.
  static constexpr Duration kLeastPause = std::chrono::milliseconds(100);

  /// A viewer and its datagram address.
  struct Viewer {
    asio::ip::address peer;   ///< remote address of its TCP connection
    asio::ip::address local;  ///< local address of its TCP connection; source of its datagrams
    bool wanted = true;       ///< after its echo
    std::uint32_t copies = 1;
    bool by_group = false;                      ///< receives the group's datagrams
    std::optional<asio::ip::udp::endpoint> at;  ///< the validated address
    LocalTime received{};                       ///< time of the last valid echo
    std::shared_ptr<DatagramCounts> counts = std::make_shared<DatagramCounts>();
  };

  explicit UdpSubscribers(std::uint32_t stream) : stream_(stream) {}

  /// Adds a viewer. Returns its token, which is not predictable.
  std::uint64_t add(const asio::ip::address& peer, const asio::ip::address& local);
  /// Removes a viewer. Returns its counts.
  DatagramCounts remove(std::uint64_t token);
  /// Sets how the viewer wants its frames from now on.
  void deliver(std::uint64_t token, const Delivery& delivery);
  /// Validates an echo received from `from`.
  AddressValidation onEcho(std::span<const std::uint8_t> bytes, const asio::ip::udp::endpoint& from,
                           LocalTime now);
  /// Removes the addresses whose echoes have ceased.
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
  /// Returns the redundancy that nine of ten of the group's viewers request; 1 without viewers.
  [[nodiscard]] std::uint32_t groupCopies() const;

 private:
  std::uint32_t stream_;
  std::unordered_map<std::uint64_t, Viewer> viewers_;
};

}  // namespace hapticast::server
