// SPDX-License-Identifier: MIT
// Which way frames shall come: by the group, by datagrams of one's own, or over TCP. A way is used
// once it has been seen to work while another one still delivers, and left as soon as it is seen to
// fail; then the next one is tried, and half a minute later the best one again. Pure: times are
// arguments. Thread: network.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"
#include "common/time.hpp"

namespace hapticast::client {

enum class Transport : std::uint8_t { kGroup, kDatagrams, kTcp };
/// On the command line and in the summary.
inline constexpr std::array<const char*, 3> kWayNames{"multicast", "udp", "tcp"};
constexpr const char* transportName(Transport transport) noexcept {
  return kWayNames[static_cast<std::size_t>(transport)];
}

/// How frames shall travel where there is a choice.
struct DeliverySettings {
  Transport best = Transport::kDatagrams;  ///< kGroup falls back to kDatagrams, this to kTcp
  std::uint32_t copies = 0;                ///< of each datagram; 0: as many as the loss asks for
  /// That joins a group, by name or address; empty: the one that leads to the server.
  std::string interface_name{};
};

/// How frames travel now.
struct DeliveryStats {
  Transport transport = Transport::kTcp;
  double loss = 0.0;         ///< of datagrams, 0..1, as last measured
  std::uint32_t copies = 1;  ///< of each datagram
};

class TransportSelector {
 public:
  /// Frames come over TCP and by nothing else for so long: the way has failed. One that has worked
  /// until now has this time to go on, and is then given up at the next frames over TCP.
  static constexpr Duration kPatience = std::chrono::seconds(1);
  /// Of two ways that both work one is quicker; chosen.
  static constexpr Duration kRace = std::chrono::milliseconds(200);
  static constexpr Duration kTryAgain = std::chrono::seconds(30);
  /// Frames come that way, but no probe: chosen, four probes of a group.
  static constexpr Duration kProbePatience = std::chrono::seconds(2);

  /// The ways that there are, the best one first; the last one is kTcp.
  explicit TransportSelector(std::vector<Transport> transports);

  /// The way that is used or tried.
  [[nodiscard]] Transport transport() const { return transports_[at_]; }
  /// Whether frames come that way, so that TCP's are not needed.
  [[nodiscard]] bool works() const { return works_; }

  /// A datagram of full size has come that way.
  void probed() { probed_ = true; }
  [[nodiscard]] bool wasProbed() const { return probed_; }
  /// A whole frame has come that way.
  void onCompleteFrame(std::uint64_t id, LocalTime now);
  /// A frame has come over TCP.
  void tcpFrame(std::uint64_t id, LocalTime now);
  /// The way is of no use: it cannot be opened, is flooded, or brings no frames.
  void markFailed(const std::string& why, LocalTime now);
  /// Looks at the time; `copies`: how many of each datagram are wanted.
  void update(LocalTime now, std::uint32_t copies);

  /// What the server is to be told, once for each change.
  [[nodiscard]] std::optional<Delivery> takeRequest();
  /// What a person is to be told, once for each change.
  [[nodiscard]] std::optional<std::string> nextMessage();

 private:
  void begin(std::size_t at);
  /// Whether no newer frame has come that way, and no other numbering has begun.
  [[nodiscard]] bool newer(std::uint64_t id) const;
  [[nodiscard]] Delivery wanted() const;

  std::vector<Transport> transports_;
  std::size_t at_ = 0;
  bool works_ = false;
  bool suspected_ = false;  // it worked, and nothing has come for a while
  bool probed_ = false;
  std::uint64_t newest_ = 0;                 // whole frame that came that way
  LocalTime received_at_{};                  // that frame
  std::optional<LocalTime> narrow_since_;    // whole frames come that way, but no probe
  std::optional<LocalTime> only_tcp_since_;  // frames come over TCP that do not come that way
  LocalTime failed_at_{};                    // a way, the last time
  std::uint32_t copies_ = 1;
  std::optional<Delivery> ordered_;
  std::vector<Transport> logged_;  // ways of which it is told that they fail
  std::string messages_;
};

}  // namespace hapticast::client
