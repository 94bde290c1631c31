// SPDX-License-Identifier: MIT
// Where viewers want their datagrams: what their echoes say, as far as it is believed. An echo
// counts only from the address that the viewer's TCP connection comes from, so that nobody can
// point the stream at somebody else. Pure: no sockets, no clocks. Thread: io.
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

/// What an echo came to. The order is that of the checks.
enum class AddressValidation : std::uint8_t {
  kBelieved,      ///< the address stands, and is to be answered with a probe
  kMalformed,     ///< not 12 bytes
  kOtherStream,   ///< of another run of the server
  kUnknownToken,  ///< nobody's, or nobody's any more
  kForeign,       ///< from another host than the viewer's TCP connection
  kTooSoon,       ///< right after another one of this viewer
};
inline constexpr std::size_t kEchoVerdicts = 6;

class UdpSubscribers {
 public:
  /// Chosen: a viewer echoes every 10 s, and two of three echoes may be lost.
  static constexpr Duration kForgetAfter = std::chrono::seconds(30);
  /// Chosen: half of what a viewer waits for an answer. A probe is a hundred times its echo: this
  /// bounds what a viewer can make of it.
  static constexpr Duration kLeastPause = std::chrono::milliseconds(100);

  struct Viewer {
    asio::ip::address peer;   ///< of its TCP connection
    asio::ip::address local;  ///< where that came to: datagrams leave from it
    bool wanted = true;       ///< once it has echoed
    std::uint32_t copies = 1;
    bool by_group = false;  ///< it takes the group's datagrams
    std::optional<asio::ip::udp::endpoint> at;
    LocalTime received{};
    std::shared_ptr<DatagramCounts> counts = std::make_shared<DatagramCounts>();
  };

  explicit UdpSubscribers(std::uint32_t stream) : stream_(stream) {}

  /// A viewer is welcomed; returns its token.
  std::uint64_t add(const asio::ip::address& peer, const asio::ip::address& local);
  /// It has left; what was counted of it.
  DatagramCounts remove(std::uint64_t token);
  /// How it wants its frames from now on.
  void deliver(std::uint64_t token, const Delivery& delivery);
  /// Reads an echo that came from `from`.
  AddressValidation onEcho(std::span<const std::uint8_t> bytes, const asio::ip::udp::endpoint& from,
                           LocalTime now);
  /// Forgets where those are whose echoes have ceased.
  void forget(LocalTime now);

  /// The viewer that has this token, null where none has.
  [[nodiscard]] Viewer* find(std::uint64_t token);
  /// Calls take(token, viewer) for all to whom datagrams go.
  template <class Visit>
  void forEachSubscriber(Visit&& visit) {
    for (auto& [token, viewer] : viewers_) {
      if (viewer.at && viewer.wanted) visit(token, viewer);
    }
  }
  [[nodiscard]] bool hasSubscribers() const;
  [[nodiscard]] DatagramCounts counts() const;
  [[nodiscard]] std::size_t size() const { return viewers_.size(); }
  /// What nine of ten of the group's viewers ask for, 1 where there are none.
  [[nodiscard]] std::uint32_t groupCopies() const;

 private:
  std::uint32_t stream_;
  std::unordered_map<std::uint64_t, Viewer> viewers_;
};

}  // namespace hapticast::server
